// The longest edge of a cell and the number of half-edges beyond a limit, triangle by triangle.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/math/float4.h"

namespace lodestone {

class EdgeLengths {
 public:
  explicit EdgeLengths(float limit) : limit2_(all4(limit * limit)) {}

  // The three edges of a triangle as vectors, of either direction.
  void add(Float4 ab, Float4 bc, Float4 ca) {
    const Float4 length2 = squared_lengths(ab, bc, ca);
    longest2_ = max(length2, longest2_);
    over_ -= length2 > limit2_;  // -1 in every lane where that is so
  }
  [[nodiscard]] float longest2() const { return std::max({longest2_[0], longest2_[1], longest2_[2]}); }
  // Of at most 2^32 - 1 triangles.
  [[nodiscard]] std::uint64_t over() const {
    std::uint64_t sum = 0;
    for (int k = 0; k < 3; ++k) sum += static_cast<std::uint32_t>(over_[k]);
    return sum;
  }

 private:
  Float4 limit2_, longest2_{};
  Int4 over_{};
};

}  // namespace lodestone
