// Ranges of a row of numbered slots, given out and taken back: first fit, neighbours merged.
#pragma once

#include <cstdint>
#include <iterator>
#include <map>
#include <optional>

namespace lodestone {

class RangeAllocator {
 public:
  explicit RangeAllocator(std::uint64_t slots) : free_slots_(slots) {
    if (slots > 0) free_.emplace(0, slots);
  }

  // The first of `count` consecutive free slots, which are no longer free; nothing when there are none. count = 0: 0.
  [[nodiscard]] std::optional<std::uint64_t> allocate(std::uint64_t count) {
    if (count == 0) return 0;
    for (auto range = free_.begin(); range != free_.end(); ++range) {
      const auto [first, length] = *range;
      if (length < count) continue;
      free_.erase(range);
      if (length > count) free_.emplace(first + count, length - count);
      free_slots_ -= count;
      return first;
    }
    return std::nullopt;
  }

  // Takes back a range as it was given out.
  void release(std::uint64_t first, std::uint64_t count) {
    if (count == 0) return;
    auto range = free_.emplace(first, count).first;
    free_slots_ += count;
    if (const auto next = std::next(range); next != free_.end() && range->first + range->second == next->first) {
      range->second += next->second;
      free_.erase(next);
    }
    if (range == free_.begin()) return;
    if (const auto previous = std::prev(range); previous->first + previous->second == range->first) {
      previous->second += range->second;
      free_.erase(range);
    }
  }

  [[nodiscard]] std::uint64_t free_slots() const { return free_slots_; }

 private:
  std::map<std::uint64_t, std::uint64_t> free_;  // first slot, length
  std::uint64_t free_slots_;
};

}  // namespace lodestone
