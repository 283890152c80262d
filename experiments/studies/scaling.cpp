// Experiment `scaling`: what more workers bring.
//
// One run times all numbers of workers, taking turns, so that a machine that drifts does so for all of them alike, and
// knows the time of one worker that speed-up is measured against. Strong scaling does the same work with more workers;
// weak scaling gives every worker as much to do as one alone has. Workers are bound to as many processors as there
// are of them, on different cores as long as there are some: else one would wander over all, and two share a core or
// not.
#include "experiments/metrics/cost/scaling.h"

#include <algorithm>

#include "experiments/studies/experiment.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/scaling_work.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/result_hash.h"
#include "experiments/subjects/row.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/processors.h"
#include "parallel/scheduler/trace.h"
#include "render/position_map/map_view.h"

namespace lodestone {
namespace scaling_study {

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{
      threads_parameter(),
      rounds_parameter(5),
      as_condition({"task", "build", "", "what the workers do", 0, 0, scaling_tasks()}),
      as_condition(
          {"mode", "strong", "", "strong: the same work for all; weak: as much for each", 0, 0, {"strong", "weak"}}),
      as_condition({"resolution", 256.0, "pixels", "of reconstruct, along the longest side", 8, largest_map_side, {}}),
      as_condition({"frames", 8, "", "of raster, once around the model", 2, 10000, {}}),
  };
  append(list, build_parameters());
  append(list, {as_condition({"width", 640, "pixels", "of raster", 16, 16384, {}}),
                as_condition({"height", 360, "pixels", "of raster", 16, 16384, {}})});
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list{
      {"workers", "", "that did it", count},
      {"processors", "", "that the workers were bound to, on different cores first", count},
      {"work", "", "triangles of the input, or pixels", count},
      {"speedup", "", "work per second over that of one worker", cost},
      {"efficiency", "%", "speed-up over workers", cost},
      {"karp_flatt",
       "",
       "serial share that would explain the speed-up; of strong scaling",
       cost,
       {ColumnNeed{{{"mode", "strong"}}}, ColumnNeed{{{"threads", 1, false}}}}},
      {"busy", "%", "of the workers' time, inside tasks", cost},
      {"idle", "s", "of all workers together, not inside tasks", cost},
      {"idle_tail", "s", "at the end, with a worker that has nothing left to do", cost},
      {"hash", "", "of the result", label},
      {"same", "", "the result is the same for all rounds, and for all numbers of workers where the work is", label},
  };
  add_spread_columns(list, "seconds", "s", "wall");
  add_spread_columns(list, "cpu_seconds", "s", "processor time of all threads");
  return list;
}

// 1, 2, 4, ... and the most.
std::vector<int> worker_counts(int most) {
  std::vector<int> counts;
  for (int n = 1; n < most; n *= 2) counts.push_back(n);
  counts.push_back(most);
  return counts;
}

// The job of one number of workers, and its times.
struct Contender {
  int workers = 1;
  std::vector<int> processors;
  std::size_t bound = 0;  // processors, as the system says while the job runs
  std::shared_ptr<Trace> trace;
  std::unique_ptr<Scheduler> scheduler;
  std::unique_ptr<ScalingJob> job;
  Rounds times;
  std::vector<double> busy, tail;
  std::vector<std::uint64_t> hashes;

  Contender(int n, const std::vector<int>& all, const IndexedMesh& mesh, const Parameters& parameters,
            const RunContext& context)
      : workers(n),
        processors(all.begin(), all.begin() + std::min<std::ptrdiff_t>(n, std::ssize(all))),
        trace(std::make_shared<Trace>(n)),
        scheduler(make_tracing_scheduler(make_tbb_scheduler(n), trace)),
        job(make_scaling_job(mesh, parameters, context, parameters.text("mode") == "weak" ? n : 1, *scheduler)) {}

  void warm_up() {
    const BoundThreads binding(processors);
    job->prepare();
    job->run();
  }
  void run() {
    const BoundThreads binding(processors);
    bound = allowed_processors().size();
    job->prepare();
    const double begin = trace->now();
    const CpuClock clock;
    job->run();
    times.add(clock.elapsed());
    const TraceSummary use = summarize(*trace, begin);
    busy.push_back(use.busy), tail.push_back(use.idle_tail);
    hashes.push_back(job->hash());
  }
};

std::vector<Contender> race(const Parameters& parameters, const RunContext& context) {
  const std::unique_ptr<Scheduler> all = study_scheduler(parameters);
  const StudyMesh input = read_study_mesh(context, *all);
  const std::vector<int> processors = one_per_core_first(allowed_processors());
  std::vector<Contender> contenders;
  for (const int n : worker_counts(all->workers()))
    contenders.emplace_back(n, processors, input.mesh, parameters, context);
  for (Contender& contender : contenders) contender.warm_up();
  const int rounds = parameters.integer("rounds");
  for (int round = 0; round < rounds; ++round) {
    for (Contender& contender : contenders) {
      check_cancelled(context);
      contender.run();
    }
    context.progress(static_cast<double>(round + 1) / rounds);
  }
  return contenders;
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const bool strong = parameters.text("mode") == "strong";
  const std::vector<Contender> contenders = race(parameters, context);
  std::vector<ThreadTime> times;
  for (const Contender& c : contenders) times.push_back({c.workers, spread_of(c.times.wall).median, c.job->work()});
  const std::vector<Scaling> results = scaling(times);

  std::vector<Row> rows;
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    const Contender& c = contenders[i];
    const std::uint64_t expected = strong ? contenders.front().hashes.front() : c.hashes.front();
    Row row;
    add_spread(row, "seconds", c.times.wall);
    add_spread(row, "cpu_seconds", c.times.cpu);
    row["workers"] = c.workers, row["processors"] = c.bound, row["work"] = c.job->work();
    row["speedup"] = results[i].speedup, row["efficiency"] = 100 * results[i].efficiency;
    row["karp_flatt"] = strong && c.workers > 1 ? Row(results[i].karp_flatt) : Row();
    const double busy = spread_of(c.busy).median;
    row["busy"] = 100 * busy, row["idle_tail"] = spread_of(c.tail).median;
    row["idle"] = (1 - busy) * c.workers * times[i].seconds;
    row["hash"] = to_hex(c.hashes.front());
    row["same"] = std::ranges::all_of(c.hashes, [&](std::uint64_t hash) { return hash == expected; });
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<SettingFault> check(const Parameters& parameters) {
  SettingVerdict verdict;
  const std::string name = parameters.text("task"), task = assignment(parameters, "task");
  verdict.idle(name != "reconstruct", "resolution", task);
  for (const char* of_raster : {"frames", "width", "height"}) verdict.idle(name != "raster", of_raster, task);
  const bool builds = name == "build" || name == "raster";
  for (const ParameterInfo& info : build_parameters()) verdict.idle(!builds, info.name, task);
  if (builds) check_build(verdict, parameters);
  return std::move(verdict).faults();
}

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.spread("seconds");
  verdict.spread("cpu_seconds");
  verdict.present("hash");
  verdict.is_true("same");
  verdict.at_most("busy", 100.001);
  verdict.in_order("processors", "workers");
  for (const Row& row : rows) {
    const double workers = number_in(row, "workers").value_or(0), speedup = number_in(row, "speedup").value_or(0);
    verdict.require(workers >= 1, "a row has no workers");
    verdict.require(
        std::abs(number_in(row, "efficiency").value_or(0) * workers - 100 * speedup) <= 1e-6 * 100 * speedup,
        "efficiency is not speed-up over workers");
    const Row& one = rows.front();
    const double rate = number_in(row, "work").value_or(0) / number_in(row, "seconds").value_or(0);
    const double base = number_in(one, "work").value_or(0) / number_in(one, "seconds").value_or(0);
    verdict.require(std::abs(rate / base - speedup) <= 1e-6 * speedup,
                    "speed-up does not follow from work and seconds");
    if (parameters.text("mode") == "strong")
      verdict.require(text_in(row, "hash") == text_in(one, "hash"), "results differ between numbers of workers");
  }
  return std::move(verdict).messages();
}

}  // namespace scaling_study

Experiment scaling_experiment() {
  using namespace scaling_study;
  return {"scaling", "What do more workers bring, for the same work and for as much work each?",
          true,      parameters(),
          columns(), scaling_study::run,
          verify,    check};
}

}  // namespace lodestone
