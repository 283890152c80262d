#include "experiments/studies/rounds.h"

#include "experiments/subjects/row.h"

namespace lodestone {

void add_times(Row& row, const Rounds& rounds) {
  add_spread(row, "seconds", rounds.wall);
  add_spread(row, "cpu_seconds", rounds.cpu);
}

ParameterInfo rounds_parameter(int rounds) {
  return as_condition({"rounds", rounds, "", "times that it is timed, after a round that warms up", 1, 1000, {}});
}

void check_cancelled(const RunContext& context) {
  if (context.cancel && *context.cancel) throw Cancelled{};
}

Rounds time_rounds(int rounds, const RunContext& context, const std::function<StageTime()>& body) {
  Rounds times;
  (void)body();
  for (int round = 0; round < rounds; ++round) {
    check_cancelled(context);
    times.add(body());
    context.progress(static_cast<double>(round + 1) / (rounds + 1));
  }
  return times;
}

}  // namespace lodestone
