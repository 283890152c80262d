// A queue of vertices by distance for searches that take the nearest first, and add none nearer than that.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/spherical/topology/sides.h"

namespace lodestone::spherical {

// Lists of distances that lie together wait in a ring; only the nearest list is a heap, so that it is a small one.
// The order is exact, and of equal distances the lower vertex comes first.
class NearQueue {
 public:
  // Empties the queue. Distances added are at most `reach` beyond the one taken last; `step` is about that of
  // neighbouring vertices, and tells how far apart the lists are.
  void begin(float step, float reach) {
    const float width = std::max(step / 8, reach / (lists - 2));
    scale_ = width > 1e-30f ? 1 / width : 0;  // 0: all in the heap
    heads_.assign(lists, none);
    entries_.clear();
    heap_.clear();
    current_ = 0;
    waiting_ = 0;
  }

  void push(Id v, float distance) {
    // Bits of floats that are not negative are in the order of the floats.
    const std::uint64_t key = std::uint64_t{std::bit_cast<std::uint32_t>(distance)} << 32 | v;
    const auto list = static_cast<std::uint64_t>(distance * scale_);
    if (list <= current_) {
      heap_.push_back(key);
      std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
      return;
    }
    std::uint32_t& head = heads_[list % lists];
    entries_.push_back({key, head});
    head = static_cast<std::uint32_t>(entries_.size() - 1);
    ++waiting_;
  }

  // Takes the nearest; false if there is none. `prepare` is called with those to come next: vertices in the lower half.
  template <class Prepare>
  bool pop(Id& v, float& distance, const Prepare& prepare) {
    while (heap_.empty()) {
      if (waiting_ == 0) return false;
      std::uint32_t& head = heads_[++current_ % lists];
      for (; head != none; head = entries_[head].next, --waiting_) heap_.push_back(entries_[head].key);
      prepare(std::span<const std::uint64_t>(heap_));
      std::make_heap(heap_.begin(), heap_.end(), std::greater<>());
    }
    v = static_cast<Id>(heap_.front());
    distance = std::bit_cast<float>(static_cast<std::uint32_t>(heap_.front() >> 32));
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
    heap_.pop_back();
    return true;
  }

 private:
  static constexpr std::size_t lists = 256;
  static constexpr std::uint32_t none = 0xFFFF'FFFFu;
  struct Entry {
    std::uint64_t key = 0;
    std::uint32_t next = 0;  // of the same list
  };

  std::vector<std::uint32_t> heads_;
  std::vector<Entry> entries_;
  std::vector<std::uint64_t> heap_;
  float scale_ = 0;
  std::uint64_t current_ = 0;
  std::size_t waiting_ = 0;
};

}  // namespace lodestone::spherical
