#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "core/base/disjoint_sets.h"

namespace lodestone {
namespace {

// The slow, obvious twin: a label for each number, all of them rewritten when two sets are united.
class LabelledSets {
 public:
  explicit LabelledSets(std::size_t count) {
    for (std::uint32_t v = 0; v < count; ++v) label_.push_back(v);
  }
  bool unite(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t from = std::max(label_[a], label_[b]), to = std::min(label_[a], label_[b]);
    std::replace(label_.begin(), label_.end(), from, to);
    return from != to;
  }
  [[nodiscard]] std::uint32_t find(std::uint32_t v) const { return label_[v]; }

 private:
  std::vector<std::uint32_t> label_;
};

TEST(DisjointSets, AreThoseOfLabels) {
  std::mt19937 random(7);
  for (const std::size_t count : {1u, 2u, 10u, 300u}) {
    DisjointSets sets(count);
    LabelledSets slow(count);
    for (std::size_t k = 0; k < count; ++k) {
      const auto a = static_cast<std::uint32_t>(random() % count), b = static_cast<std::uint32_t>(random() % count);
      EXPECT_EQ(sets.unite(a, b), slow.unite(a, b));
      for (std::uint32_t v = 0; v < count; ++v) ASSERT_EQ(sets.find(v), slow.find(v));
    }
  }
}

TEST(DisjointSets, DoNotDependOnTheOrder) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::mt19937 random(8);
  for (int k = 0; k < 60; ++k) pairs.emplace_back(random() % 100, random() % 100);
  DisjointSets forward(100), backward(100);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    forward.unite(pairs[k].first, pairs[k].second);
    const auto& [a, b] = pairs[pairs.size() - 1 - k];
    backward.unite(b, a);
  }
  for (std::uint32_t v = 0; v < 100; ++v) EXPECT_EQ(forward.find(v), backward.find(v));
}

TEST(DisjointSets, Grow) {
  DisjointSets sets;
  EXPECT_EQ(sets.size(), 0u);
  EXPECT_EQ(sets.add(), 0u);
  EXPECT_EQ(sets.add(), 1u);
  EXPECT_NE(sets.find(0), sets.find(1));
  EXPECT_TRUE(sets.unite(1, 0));
  EXPECT_FALSE(sets.unite(0, 1));
  EXPECT_EQ(sets.find(1), 0u);
  EXPECT_EQ(sets.size(), 2u);
}

}  // namespace
}  // namespace lodestone
