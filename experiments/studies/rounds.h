// Timing in rounds, after one that warms up.
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
  [[nodiscard]] StageTime median() const { return {median_of(wall), median_of(cpu)}; }
};

// The columns seconds and cpu_seconds with their minima and maxima.
void add_times(Row& row, const Rounds& rounds);

// "rounds" of a run: the number of times that it is timed, after a round that warms up and does not count.
[[nodiscard]] ParameterInfo rounds_parameter(int rounds);

// Throws Cancelled when the run is to end.
void check_cancelled(const RunContext& context);

// Calls body once without looking at the clock, then `rounds` times: what body returns is kept. Looks for cancellation
// in between.
[[nodiscard]] Rounds time_rounds(int rounds, const RunContext& context, const std::function<StageTime()>& body);

}  // namespace lodestone
