#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "experiments/metrics/cost/order_statistics.h"

namespace lodestone {
namespace {

TEST(Spread, OfOddEvenAndNone) {
  const Spread odd = spread_of({9, 1, 4});
  EXPECT_EQ(odd.median, 4);
  EXPECT_EQ(odd.minimum, 1);
  EXPECT_EQ(odd.maximum, 9);
  EXPECT_EQ(median_of({3}), 3);
  EXPECT_EQ(median_of({9, 1, 4, 5}), 4.5);
  EXPECT_EQ(median_of({}), 0);
}

TEST(Quantile, IsTheLeastValueThatTheShareDoesNotExceed) {
  std::mt19937 random(1);
  for (const std::size_t count : {1u, 2u, 99u, 100u, 101u, 1000u})
    for (const double share : {0.001, 0.5, 0.99, 1.0}) {
      std::vector<double> values;
      for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<double>(random() % 50));
      std::vector<double> sorted = values;
      std::sort(sorted.begin(), sorted.end());
      const auto enough = std::find_if(sorted.begin(), sorted.end(), [&](double value) {
        const auto not_above = std::upper_bound(sorted.begin(), sorted.end(), value) - sorted.begin();
        return static_cast<double>(not_above) >= share * static_cast<double>(count);
      });
      EXPECT_EQ(quantile(values, share), *enough) << count << " values, share " << share;
    }
  std::vector<float> none;
  EXPECT_EQ(quantile(none, 0.5), 0);
}

}  // namespace
}  // namespace lodestone
