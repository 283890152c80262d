#include "experiments/metrics/cost/scaling.h"

#include <cmath>
#include <random>
#include <set>
#include <string>

#include "core/base/error.h"
#include "experiments/metrics/cost/order_statistics.h"

namespace lodestone {
namespace {

// The row of one thread, after looking at all of them.
const ThreadTime& check_rows(std::span<const ThreadTime> times) {
  const ThreadTime* one = nullptr;
  std::set<int> seen;
  for (const ThreadTime& row : times) {
    const auto positive = [](double v) { return v > 0 && std::isfinite(v); };
    if (row.threads < 1 || !positive(row.seconds) || !positive(row.work))
      throw InputError("a time of " + std::to_string(row.threads) +
                       " threads is out of range; threads, seconds and work must be positive");
    if (!seen.insert(row.threads).second)
      throw InputError("two times of " + std::to_string(row.threads) + " threads; give their median");
    if (row.threads == 1) one = &row;
  }
  if (!one) throw InputError("no time of one thread: there is nothing that speed-up is measured against");
  return *one;
}

std::vector<double> drawn_anew(const std::vector<double>& values, std::mt19937& random) {
  std::vector<double> drawn(values.size());
  for (double& value : drawn) value = values[random() % values.size()];
  return drawn;
}

Interval middle_of(std::vector<double>& values) { return {quantile(values, 0.025), quantile(values, 0.975)}; }

}  // namespace

std::vector<Scaling> scaling(std::span<const ThreadTime> times) {
  const ThreadTime& one = check_rows(times);
  std::vector<Scaling> rows;
  for (const ThreadTime& row : times) {
    Scaling s{row.threads, row.seconds, 1, 1, 0};
    const double threads = row.threads;
    s.speedup = (row.work / row.seconds) / (one.work / one.seconds);
    s.efficiency = s.speedup / threads;
    if (row.threads > 1 && row.work == one.work) s.karp_flatt = (1 / s.speedup - 1 / threads) / (1 - 1 / threads);
    rows.push_back(s);
  }
  return rows;
}

ScalingIntervals scaling_intervals(const std::vector<double>& one, const std::vector<double>& many, int threads,
                                   double work) {
  if (one.empty() || many.empty()) throw InputError("a scaling without rounds");
  if (threads == 1) return {{1, 1}, {0, 0}};
  std::mt19937 random(1);
  std::vector<double> speedups, shares;
  for (int draw = 0; draw < 2000; ++draw) {
    const double alone = median_of(drawn_anew(one, random)), together = median_of(drawn_anew(many, random));
    const Scaling drawn = scaling(std::vector<ThreadTime>{{1, alone, 1}, {threads, together, work}}).back();
    speedups.push_back(drawn.speedup), shares.push_back(drawn.karp_flatt);
  }
  return {middle_of(speedups), middle_of(shares)};
}

}  // namespace lodestone
