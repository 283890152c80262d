// Disjoint sets of numbers (union-find), with paths halved on the way. The smallest number of a set stands for it, so
// that what the sets are called does not depend on the order in which they were united.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace lodestone {

class DisjointSets {
 public:
  DisjointSets() = default;
  explicit DisjointSets(std::size_t count) : root_(count) { std::iota(root_.begin(), root_.end(), 0u); }

  [[nodiscard]] std::size_t size() const { return root_.size(); }
  // A set of one.
  std::uint32_t add() {
    root_.push_back(static_cast<std::uint32_t>(root_.size()));
    return root_.back();
  }
  // The smallest number of v's set.
  [[nodiscard]] std::uint32_t find(std::uint32_t v) {
    while (root_[v] != v) v = root_[v] = root_[root_[v]];
    return v;
  }
  // True if two sets became one.
  bool unite(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    root_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }

 private:
  std::vector<std::uint32_t> root_;
};

}  // namespace lodestone
