#include "experiments/metrics/cost/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lodestone {

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double lower = values[(values.size() - 1) / 2], upper = values[values.size() / 2];
  return {lower + (upper - lower) / 2, values.front(), values.back()};
}

template <typename T>
double quantile(std::vector<T>& values, double share) {
  if (values.empty()) return 0;
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto at = values.begin() + std::max<std::ptrdiff_t>(rank, 1) - 1;
  std::nth_element(values.begin(), at, values.end());
  return *at;
}
template double quantile(std::vector<float>& values, double share);
template double quantile(std::vector<double>& values, double share);

}  // namespace lodestone
