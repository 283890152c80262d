// Experiment `scaling`: what more workers bring.
//
// One run times all numbers of workers, and knows the time of one worker that speed-up is measured against. Strong
// scaling does the same work with more workers; weak scaling gives every worker as much to do as one alone has.
#include "experiments/metrics/cost/scaling.h"

#include <algorithm>
#include <cmath>

#include "experiments/studies/experiment.h"
#include "experiments/studies/scaling/scaling_race.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/result_hash.h"
#include "experiments/subjects/row.h"
#include "parallel/scheduler/processors.h"
#include "parallel/scheduler/trace.h"

namespace lodestone {
namespace scaling_study {

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list = race_parameters();
  list.insert(list.begin(), threads_parameter());
  list.insert(
      list.begin() + 3,
      as_condition(
          {"mode", "strong", "", "strong: the same work for all; weak: as much for each", 0, 0, {"strong", "weak"}}));
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list{
      {"workers", "", "that did it", count},
      {"processors", "", "that the workers were bound to", count},
      {"cores", "", "that these belong to: fewer than workers where hardware threads share one", count},
      {"nodes", "", "memories (NUMA) that these are next to", count},
      {"work", "", "triangles of the input, or pixels", count},
      {"speedup", "", "work per second over that of one worker", cost},
      {"efficiency", "%", "speed-up over workers", cost},
      {"karp_flatt",
       "",
       "serial share that would explain the speed-up; of strong scaling",
       cost,
       {ColumnNeed{{{"mode", "strong"}}}, ColumnNeed{{{"threads", 1, false}}}}},
      {"speedup_low", "", "least of what 95 % of rounds drawn anew give (bootstrap)", cost},
      {"speedup_high", "", "most of it", cost},
      {"karp_flatt_low", "", "likewise", cost, {ColumnNeed{{{"mode", "strong"}}}, ColumnNeed{{{"threads", 1, false}}}}},
      {"karp_flatt_high",
       "",
       "likewise",
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

// How the workers spent their time, medians of the rounds.
void add_use(Row& row, const Contender& contender) {
  std::vector<double> busy, tail;
  for (const Contender::Round& round : contender.rounds) {
    const TraceSummary use = summarize(*contender.trace, round.begin, round.end);
    busy.push_back(use.busy), tail.push_back(use.idle_tail);
  }
  row["busy"] = 100 * median_of(busy), row["idle_tail"] = median_of(tail);
  row["idle"] = (1 - median_of(busy)) * contender.workers * median_of(contender.times().wall);
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const bool strong = parameters.text("mode") == "strong";
  const std::unique_ptr<Scheduler> all = study_scheduler(parameters);
  const StudyMesh input = read_study_mesh(context, *all);
  const std::vector<Contender> contenders = race(input.mesh, all->workers(), !strong, parameters, context);
  std::vector<ThreadTime> times;
  for (const Contender& c : contenders) times.push_back({c.workers, median_of(c.times().wall), c.job->work()});
  const std::vector<Scaling> results = scaling(times);

  std::vector<Row> rows;
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    const Contender& c = contenders[i];
    const std::uint64_t expected = strong ? contenders.front().hashes.front() : c.hashes.front();
    Row row;
    add_times(row, c.times());
    row["workers"] = c.workers, row["processors"] = c.bound, row["work"] = c.job->work();
    row["cores"] = count_cores(c.processors), row["nodes"] = count_nodes(c.processors);
    row["speedup"] = results[i].speedup, row["efficiency"] = 100 * results[i].efficiency;
    const ScalingIntervals intervals = scaling_intervals(contenders.front().times().wall, c.times().wall, c.workers,
                                                         c.job->work() / contenders.front().job->work());
    row["speedup_low"] = intervals.speedup.low, row["speedup_high"] = intervals.speedup.high;
    const auto share = [&](double value) { return strong && c.workers > 1 ? Row(value) : Row(); };
    row["karp_flatt"] = share(results[i].karp_flatt);
    row["karp_flatt_low"] = share(intervals.karp_flatt.low), row["karp_flatt_high"] = share(intervals.karp_flatt.high);
    add_use(row, c);
    row["hash"] = to_hex(c.hashes.front());
    row["same"] = std::ranges::all_of(c.hashes, [&](std::uint64_t hash) { return hash == expected; });
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<SettingFault> check(const Parameters& parameters) {
  SettingVerdict verdict;
  check_race(verdict, parameters);
  return std::move(verdict).faults();
}

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.spread("seconds");
  verdict.spread("cpu_seconds");
  verdict.present("hash");
  verdict.is_true("same");
  verdict.at_most("busy", 100.001);
  if (parameters.text("affinity") != "free") verdict.in_order("processors", "workers");
  verdict.in_order("cores", "processors");
  verdict.in_order("speedup_low", "speedup_high");
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
