// A queue of vertices by rank, ties by number: lowest first. Keys are 64-bit integers, since the bits of floats that
// are not negative are in their order.
//
// The first vertices are sorted once, digit by digit, and read in a row; a binary heap has only those that come
// later. Both without branches that depend on the keys, which cannot be predicted.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/progressive/collapse/ring.h"

namespace lodestone::progressive {

class RankHeap {
 public:
  void clear() { sorted_.clear(), keys_.clear(), next_ = 0; }
  [[nodiscard]] bool empty() const { return next_ == sorted_.size() && keys_.empty(); }
  [[nodiscard]] float lowest() const {
    const std::uint64_t key = std::min(first_sorted(), first_pushed());
    return key == none ? std::numeric_limits<float>::infinity()
                       : std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32));
  }
  // Adds out of order; order_all() has to follow before anything else.
  void add(float rank, Id vertex) { sorted_.push_back(key(rank, vertex)); }
  void order_all() {
    sort_by_rank();
    for (auto from = sorted_.begin(); from != sorted_.end();) {
      const std::uint64_t rank = *from >> 32;
      auto to = from + 1;
      while (to != sorted_.end() && *to >> 32 == rank) ++to;
      if (to - from > 1) std::sort(from, to);
      from = to;
    }
  }
  void push(float rank, Id vertex) {
    keys_.push_back(0);
    rise(keys_.size() - 1, key(rank, vertex));
  }
  Id pop() {
    if (first_sorted() < first_pushed()) return static_cast<Id>(sorted_[next_++]);
    const std::uint64_t top = keys_.front(), last = keys_.back();
    keys_.pop_back();
    if (!keys_.empty()) rise(sink(), last);
    return static_cast<Id>(top);
  }

 private:
  static constexpr std::uint64_t none = ~std::uint64_t{0};  // above every key: its rank is not a number

  static std::uint64_t key(float rank, Id vertex) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(rank)} << 32 | vertex;
  }
  [[nodiscard]] std::uint64_t first_sorted() const { return next_ < sorted_.size() ? sorted_[next_] : none; }
  [[nodiscard]] std::uint64_t first_pushed() const { return keys_.empty() ? none : keys_.front(); }

  // By the upper half of the keys, from its lowest digit to its highest.
  void sort_by_rank() {
    constexpr std::size_t digits = 4, values = 256;
    std::uint32_t places[digits][values] = {};
    const auto digit = [](std::uint64_t key, std::size_t d) { return static_cast<std::uint8_t>(key >> (32 + 8 * d)); };
    for (const std::uint64_t key : sorted_)
      for (std::size_t d = 0; d < digits; ++d) ++places[d][digit(key, d)];
    spare_.resize(sorted_.size());
    for (std::size_t d = 0; d < digits; ++d) {
      std::uint32_t before = 0;
      for (std::uint32_t& place : places[d]) before += std::exchange(place, before);
      for (const std::uint64_t key : sorted_) spare_[places[d][digit(key, d)]++] = key;
      std::swap(sorted_, spare_);
    }
  }

  // Moves the lower child of the top up, without a branch, until there is none; returns the hole.
  std::size_t sink() {
    const std::size_t count = keys_.size();
    std::size_t at = 0, child = 1;
    for (; child + 1 < count; child = 2 * at + 1) {
      child += keys_[child + 1] < keys_[child] ? 1 : 0;
      keys_[at] = keys_[child];
      at = child;
    }
    if (child < count) keys_[at] = keys_[child], at = child;
    return at;
  }
  void rise(std::size_t at, std::uint64_t value) {
    for (; at > 0 && value < keys_[(at - 1) / 2]; at = (at - 1) / 2) keys_[at] = keys_[(at - 1) / 2];
    keys_[at] = value;
  }

  std::vector<std::uint64_t> sorted_, spare_, keys_;  // keys_: the heap
  std::size_t next_ = 0;                              // of sorted_, to be read
};

}  // namespace lodestone::progressive
