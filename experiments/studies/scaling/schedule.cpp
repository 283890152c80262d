// Experiment `schedule`: what would limit more workers than the machine has.
//
// One worker is recorded; what it did is replayed by list scheduling on any number of virtual workers. What workers
// take from each other (memory, caches, clock) is measured apart from what is predicted: by as many copies of the job,
// each on one worker, at once. The prediction can therefore be held against the race of the real workers.
#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "experiments/metrics/schedule/list_schedule.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/scaling/scaling_race.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/result_hash.h"
#include "experiments/subjects/row.h"
#include "parallel/scheduler/memory_rate.h"

namespace lodestone {
namespace schedule_study {

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list = race_parameters();
  list.insert(list.begin(), threads_parameter());
  append(
      list,
      {as_condition({"virtual_workers", 4096, "", "most workers to predict", 1, 1 << 20, {}}),
       as_condition({"array", 512, "MiB", "of memory_rate, one of three; exceeds the largest cache", 1, 1 << 20, {}})});
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list{
      {"workers", "", "virtual ones", count},
      {"predicted", "s", "wall, replayed by list scheduling", cost},
      {"speedup", "", "recorded work over predicted", cost},
      {"efficiency", "%", "speed-up over workers", cost},
      {"streaming_speedup", "",
       "at most, of work that takes memory as fast as one worker can: the ceiling of this machine", cost},
      {"slowdown", "", "of a job beside others: as many copies as workers, or as the machine has, at once", cost},
      {"memory_rate", "GB/s", "that as many workers, or as the machine has, get at once", cost},
      {"work", "s", "of one worker, recorded", cost},
      {"span", "s", "longest chain of tasks", cost},
      {"parallelism", "", "work over span: no number of workers is faster by more", cost},
      {"workers_at_80", "", "most virtual workers with an efficiency of 80 %", count},
      {"triangles", "", "of the input", count},
      {"tasks", "", "recorded", count},
      {"critical", "", "what the span consists of, % of it", label},
      {"limit", "", "what the program does while workers are idle, % of their time", label},
      {"measured", "s", "wall of the real workers, median; null beyond the machine", cost},
      {"error", "%", "of predicted, over measured; null beyond the machine", accuracy},
      {"hash", "", "of the result", label},
  };
  return list;
}

// The median processor seconds of a job of one worker when so many copies of it run at once.
double seconds_of_copies(int copies, const IndexedMesh& mesh, const Parameters& parameters, const RunContext& context) {
  const auto scheduler = make_tbb_scheduler(copies);
  std::vector<double> seconds(static_cast<std::size_t>(copies));
  std::atomic<int> begun = 0;
  scheduler->for_chunks(seconds.size(), 1, [&](ChunkRange copy) {
    const auto alone = make_tbb_scheduler(1);
    const auto job = make_scaling_job(mesh, parameters, context, 1, *alone);
    job->prepare(), job->run();
    // All are to be at work at once; if a worker were late by this much, the copies would run one after the other.
    const Stopwatch waited;
    for (++begun; begun < copies && waited.seconds() < 10;) continue;
    std::vector<double> rounds;
    for (int round = 0; round < parameters.integer("rounds"); ++round) {
      job->prepare();
      const double begin = thread_cpu_seconds();
      job->run();
      rounds.push_back(thread_cpu_seconds() - begin);
    }
    seconds[copy.index] = median_of(std::move(rounds));
  });
  return median_of(std::move(seconds));
}

// Things that some real workers share.
struct Shared {
  int workers = 1;
  double slowdown = 1;
  double rate = 0;  // bytes a second
};

std::vector<Shared> shared_by(const std::vector<int>& counts, const IndexedMesh& mesh, const Parameters& parameters,
                              const RunContext& context) {
  const auto bytes = static_cast<std::size_t>(parameters.integer("array")) << 20U;
  std::vector<Shared> list;
  double alone = 0;
  for (const int n : counts) {
    check_cancelled(context);
    const double seconds = seconds_of_copies(n, mesh, parameters, context);
    if (list.empty()) alone = seconds;
    list.push_back({n, std::max(seconds / alone, 1.0), memory_rate(bytes, 5, *make_tbb_scheduler(n))});
  }
  return list;
}

// The round with the median time.
RecordedWork recorded_by(const Contender& one) {
  std::vector<Contender::Round> rounds = one.rounds;
  const auto middle = rounds.begin() + std::ssize(rounds) / 2;
  std::ranges::nth_element(rounds, middle, {}, [](const Contender::Round& r) { return r.time.cpu_seconds; });
  return recorded_work(one.trace->events(), middle->begin, middle->end, middle->time.cpu_seconds);
}

// "level 7 41 %, before partition 20 %": the largest shares.
std::string largest(const std::vector<std::pair<std::string, double>>& parts, double whole) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(parts.size(), 5); ++i) {
    const double share = 100 * parts[i].second / whole;
    if (share < 1) break;
    text += fmt::format("{}{} {:.0f} %", i > 0 ? ", " : "", parts[i].first, share);
  }
  return text;
}

std::size_t tasks_of(const RecordedWork& work) {
  std::size_t tasks = 0;
  for (const RecordedCall& call : work.calls) tasks += call.tasks.size();
  return tasks;
}

// All that is recorded and measured before anything is predicted.
struct Evidence {
  RecordedWork work;
  WorkAndSpan of_work;
  std::vector<Shared> shared;
};

// The figures of the number of real workers next below.
const Shared& nearest_to(int workers, const Evidence& evidence) {
  return *(std::ranges::upper_bound(evidence.shared, workers, {}, &Shared::workers) - 1);
}

Schedule schedule_on(int workers, const Evidence& evidence) {
  return list_schedule(evidence.work, {workers, nearest_to(workers, evidence).slowdown});
}

Row row_of(int workers, const Evidence& evidence) {
  const auto& [work, of_work, shared] = evidence;
  const Shared& nearest = nearest_to(workers, evidence);
  const double most = std::ranges::max(shared, {}, &Shared::rate).rate;
  const Schedule schedule = schedule_on(workers, evidence);
  Row row{{"workers", workers}, {"predicted", schedule.seconds}};
  row["speedup"] = of_work.work / schedule.seconds, row["efficiency"] = 100 * of_work.work / schedule.seconds / workers;
  row["streaming_speedup"] = std::min(row["speedup"].get<double>(), most / shared.front().rate);
  row["slowdown"] = nearest.slowdown, row["memory_rate"] = 1e-9 * nearest.rate;
  row["work"] = of_work.work, row["span"] = of_work.span, row["parallelism"] = of_work.work / of_work.span;
  row["tasks"] = tasks_of(work), row["critical"] = largest(of_work.critical, of_work.span);
  row["limit"] = largest(schedule.idle, schedule.seconds * workers);
  row["measured"] = Row(), row["error"] = Row();
  return row;
}

// The most workers, up to `most`, with this efficiency or more, by halving: it falls with the workers, nearly.
int workers_at(double efficiency, const Evidence& evidence, int most) {
  const auto has = [&](int workers) {
    return evidence.of_work.work >= efficiency * workers * schedule_on(workers, evidence).seconds;
  };
  int low = 1, high = most + 1;
  while (high - low > 1) (has((low + high) / 2) ? low : high) = (low + high) / 2;
  return low;
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const std::unique_ptr<Scheduler> all = study_scheduler(parameters);
  const StudyMesh input = read_study_mesh(context, *all);
  const std::vector<Contender> contenders = race(input.mesh, all->workers(), false, parameters, context);
  Evidence evidence{recorded_by(contenders.front()), {}, {}};
  evidence.of_work = work_and_span(evidence.work);
  evidence.shared = shared_by(worker_counts(all->workers()), input.mesh, parameters, context);

  std::vector<Row> rows;
  for (const Contender& c : contenders) {
    rows.push_back(row_of(c.workers, evidence));
    const double measured = median_of(c.times().wall), predicted = rows.back()["predicted"].get<double>();
    rows.back()["measured"] = measured, rows.back()["error"] = 100 * std::abs(predicted / measured - 1);
  }
  for (int n = 1; n <= parameters.integer("virtual_workers"); n *= 4)
    if (n > all->workers()) rows.push_back(row_of(n, evidence));
  const int at_80 = workers_at(0.8, evidence, parameters.integer("virtual_workers"));
  for (Row& row : rows) {
    row["hash"] = to_hex(contenders.front().hashes.front());
    row["workers_at_80"] = at_80, row["triangles"] = input.mesh.triangles.size();
  }
  return rows;
}

std::vector<SettingFault> check(const Parameters& parameters) {
  SettingVerdict verdict;
  check_race(verdict, parameters);
  return std::move(verdict).faults();
}

std::vector<std::string> verify(const Parameters&, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.present("hash");
  verdict.in_order("span", "work");
  for (const Row& row : rows) {
    const double work = number_in(row, "work").value_or(0), span = number_in(row, "span").value_or(0);
    const double workers = number_in(row, "workers").value_or(0), seconds = number_in(row, "predicted").value_or(0);
    // Brent's bounds, of any greedy schedule; the slowdown takes time, too.
    const double slowdown = number_in(row, "slowdown").value_or(0);
    verdict.require(seconds >= (1 - 1e-9) * std::max(work / workers, span), "faster than work and span permit");
    verdict.require(slowdown >= 1, "a job is faster beside others");
  }
  return std::move(verdict).messages();
}

}  // namespace schedule_study

Experiment schedule_experiment() {
  using namespace schedule_study;
  return {"schedule", "What would limit more workers than this machine has?",
          true,       parameters(),
          columns(),  schedule_study::run,
          verify,     check};
}

}  // namespace lodestone
