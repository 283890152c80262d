// An order of vertex splits in which parents are cheap to write.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lodestone::progressive {

// Splits in the order of a progressive mesh. Vertices are groups (core/progressive/mesh/activation.h), the first `base`
// of them those of the base.
struct SplitSequence {
  std::uint32_t base = 0;
  std::vector<std::uint32_t> parents;    // by split
  std::vector<std::uint32_t> star_ends;  // by split: the end of its star; it begins where the one before ends
  std::vector<std::uint32_t> stars;      // the vertices around each new one, in any order
  [[nodiscard]] std::span<const std::uint32_t> star(std::size_t split) const {
    const std::size_t begin = split > 0 ? star_ends[split - 1] : 0;
    return std::span(stars).subspan(begin, star_ends[split] - begin);
  }
};

// New numbers of all vertices: splits change places within batches, each of 1 / `share` of the vertices before it, so
// that parents mostly ascend and return to the first a few times. A split comes after those of the vertices around it:
// then it is the same split. n log n.
[[nodiscard]] std::vector<std::uint32_t> order_in_batches(const SplitSequence& splits, std::uint32_t share);

}  // namespace lodestone::progressive
