// A binary heap of vertices by rank, ties by number: lowest first. Keys are 64-bit integers, since the bits of floats
// that are not negative are in their order.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/progressive/collapse/ring.h"

namespace lodestone::progressive {

class RankHeap {
 public:
  void clear() { keys_.clear(); }
  [[nodiscard]] bool empty() const { return keys_.empty(); }
  [[nodiscard]] float lowest() const {
    return keys_.empty() ? std::numeric_limits<float>::infinity()
                         : std::bit_cast<float>(static_cast<std::uint32_t>(keys_.front() >> 32));
  }
  // Adds out of order; order_all() makes the heap.
  void add(float rank, Id vertex) { keys_.push_back(key(rank, vertex)); }
  void order_all() {
    for (std::size_t k = keys_.size() / 2; k-- > 0;) {
      const std::uint64_t moving = keys_[k];
      rise(sink(k), k, moving);
    }
  }
  void push(float rank, Id vertex) {
    keys_.push_back(0);
    rise(keys_.size() - 1, 0, key(rank, vertex));
  }
  Id pop() {
    const std::uint64_t top = keys_.front(), last = keys_.back();
    keys_.pop_back();
    if (!keys_.empty()) rise(sink(0), 0, last);
    return static_cast<Id>(top);
  }

 private:
  static std::uint64_t key(float rank, Id vertex) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(rank)} << 32 | vertex;
  }
  // Moves the lower child up, without a branch, until there is none; returns the hole.
  std::size_t sink(std::size_t at) {
    const std::size_t count = keys_.size();
    std::size_t child = 2 * at + 1;
    for (; child + 1 < count; child = 2 * at + 1) {
      child += keys_[child + 1] < keys_[child] ? 1 : 0;
      keys_[at] = keys_[child];
      at = child;
    }
    if (child < count) keys_[at] = keys_[child], at = child;
    return at;
  }
  void rise(std::size_t at, std::size_t top, std::uint64_t value) {
    for (; at > top && value < keys_[(at - 1) / 2]; at = (at - 1) / 2) keys_[at] = keys_[(at - 1) / 2];
    keys_[at] = value;
  }

  std::vector<std::uint64_t> keys_;
};

}  // namespace lodestone::progressive
