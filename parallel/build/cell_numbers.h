// Small consecutive numbers for the cells that a stretch of the input lies in.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/hierarchy/model/cell_code.h"

namespace lodestone {

// Open-addressing map from cell codes to numbers in order of first appearance; one per chunk, to fit into the cache.
class CellNumbers {
 public:
  std::uint32_t number(CellCode code) {
    if (2 * codes.size() >= slots_.size()) grow();
    std::uint32_t& slot = find(code);
    if (slot == none_) {
      slot = static_cast<std::uint32_t>(codes.size());
      codes.push_back(code);
    }
    return slot;
  }
  void clear() {
    codes.clear();
    std::fill(slots_.begin(), slots_.end(), none_);
  }
  std::vector<CellCode> codes;  // by number

 private:
  static constexpr std::uint32_t none_ = 0xffff'ffffu;

  std::uint32_t& find(CellCode code) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = (code.morton * 0x9e37'79b9'7f4a'7c15ull) >> (64 - std::countr_zero(slots_.size()));
    while (slots_[i] != none_ && codes[slots_[i]] != code) i = (i + 1) & mask;
    return slots_[i];
  }
  void grow() {
    slots_.assign(std::max<std::size_t>(64, slots_.size() * 2), none_);
    for (std::uint32_t i = 0; i < codes.size(); ++i) find(codes[i]) = i;
  }

  std::vector<std::uint32_t> slots_;
};

}  // namespace lodestone
