#include "experiments/studies/rounds.h"

namespace lodestone {

void add_spread_columns(std::vector<ColumnInfo>& columns, const std::string& name, const std::string& unit,
                        const std::string& meaning) {
  const auto kind = ColumnInfo::Kind::cost;
  columns.push_back({name, unit, meaning + ", median", kind});
  columns.push_back({name + "_min", unit, meaning + ", least", kind});
  columns.push_back({name + "_max", unit, meaning + ", most", kind});
}

void add_spread(Row& row, const std::string& name, const std::vector<double>& values) {
  const Spread spread = spread_of(values);
  row[name] = spread.median;
  row[name + "_min"] = spread.minimum;
  row[name + "_max"] = spread.maximum;
}

ParameterInfo rounds_parameter(int rounds) {
  return {"rounds", rounds, "", "times that it is timed, after a round that warms up", 1, 1000, {}};
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
