#include "experiments/metrics/cost/scaling.h"

#include <cmath>
#include <set>
#include <string>

#include "core/base/error.h"

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

}  // namespace lodestone
