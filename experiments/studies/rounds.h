// Timing: warm-up, rounds, and what becomes of them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/metrics/cost/order_statistics.h"
#include "experiments/studies/experiment.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {

// Wall and processor seconds of some rounds of the same work.
struct Rounds {
  std::vector<double> wall, cpu;
  void add(StageTime time) { wall.push_back(time.seconds), cpu.push_back(time.cpu_seconds); }
};

// name, name_min, name_max: their columns and their values.
void add_spread_columns(std::vector<ColumnInfo>& columns, const std::string& name, const std::string& unit,
                        const std::string& meaning);
void add_spread(Row& row, const std::string& name, const std::vector<double>& values);

// "rounds" of a run: as often is it timed, after a round that warms up and does not count.
[[nodiscard]] ParameterInfo rounds_parameter(int rounds);

// Throws Cancelled when the run is to end.
void check_cancelled(const RunContext& context);

// Calls body once without looking at the clock, then `rounds` times: what body returns is kept. Looks for cancellation
// in between.
[[nodiscard]] Rounds time_rounds(int rounds, const RunContext& context, const std::function<StageTime()>& body);

}  // namespace lodestone
