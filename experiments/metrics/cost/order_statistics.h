// Median, range and quantiles of a handful of times or a picture full of errors.
#pragma once

#include <utility>
#include <vector>

namespace lodestone {

struct Spread {
  double median = 0, least = 0, most = 0;
};
// Of an even number of values the median is the mean of the two in the middle. Zeros for none. O(n log n).
[[nodiscard]] Spread spread_of(std::vector<double> values);
[[nodiscard]] inline double median_of(std::vector<double> values) { return spread_of(std::move(values)).median; }

// The least value that a share of the values, in (0, 1], does not exceed; 0 for none. Reorders them. O(n).
template <typename T>
[[nodiscard]] double quantile(std::vector<T>& values, double share);
extern template double quantile(std::vector<float>& values, double share);
extern template double quantile(std::vector<double>& values, double share);

}  // namespace lodestone
