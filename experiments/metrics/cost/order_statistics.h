// Median, range and quantiles of a handful of times or a picture full of errors.
#pragma once

#include <utility>
#include <vector>

namespace lodestone {

struct Spread {
  double median = 0, minimum = 0, maximum = 0;
};
// The median of an even number of values is the mean of the two in the middle. Zeros for no values. O(n log n).
[[nodiscard]] Spread spread_of(std::vector<double> values);
[[nodiscard]] inline double median_of(std::vector<double> values) { return spread_of(std::move(values)).median; }

// The smallest value that a share of the values, in (0, 1], does not exceed; 0 for none. Reorders them. O(n).
template <typename T>
[[nodiscard]] double quantile(std::vector<T>& values, double share);
extern template double quantile(std::vector<float>& values, double share);
extern template double quantile(std::vector<double>& values, double share);

}  // namespace lodestone
