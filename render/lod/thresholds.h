// Comparisons of distances without square roots, with the same outcome: floats that take the place of radii.
//
// A rounded square root is monotone, so that sqrt(s) >= r for a float s exactly if s is not below some float. This
// serves devices whose square root is not the CPU's.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/hierarchy/model/distance_metric.h"

namespace lodestone {

// The radicand of norm(), or norm() itself, depending on the metric.
[[nodiscard]] inline float root_of(DistanceMetric metric, float s) {
  return metric == DistanceMetric::euclidean ? std::sqrt(s) : s;
}

// The smallest float s >= 0, infinity included, for which holds(s). It must hold for infinity and be monotone in s.
template <class Holds>
[[nodiscard]] float least_float(const Holds& holds) {
  std::uint32_t lo = 0, hi = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity());
  while (lo < hi) {  // bits of non-negative floats are ordered as the floats are
    const std::uint32_t middle = lo + (hi - lo) / 2;
    if (holds(std::bit_cast<float>(middle)))
      hi = middle;
    else
      lo = middle + 1;
  }
  return std::bit_cast<float>(lo);
}

// s >= threshold exactly if root_of(s) >= radius.
[[nodiscard]] inline float reaching(DistanceMetric metric, float radius) {
  return least_float([&](float s) { return root_of(metric, s) >= radius; });
}

// !(s >= threshold) exactly if limit - root_of(s) >= radius: what a detail limit leaves of its radius.
[[nodiscard]] inline float falling_below(DistanceMetric metric, float limit, float radius) {
  return least_float([&](float s) { return !(limit - root_of(metric, s) >= radius); });
}

}  // namespace lodestone
