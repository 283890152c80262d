// Sides of triangles, numbered 3 * triangle + the place at which they start, and the edges that they lie on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone::spherical {

using Id = std::uint32_t;
inline constexpr Id no_id = 0xFFFF'FFFFu;

[[nodiscard]] constexpr Id next_side(Id side) { return side % 3 == 2 ? side - 2 : side + 1; }
[[nodiscard]] constexpr Id previous_side(Id side) { return side % 3 == 0 ? side + 2 : side - 1; }
[[nodiscard]] inline Id start_of(std::span<const Triangle> triangles, Id side) {
  return triangles[side / 3].v[side % 3];
}
[[nodiscard]] inline Id end_of(std::span<const Triangle> triangles, Id side) {
  return start_of(triangles, next_side(side));
}

// The sides by edge, in the order of the lower vertex, then of the higher one, then of the sides. Memory: 24 bytes per
// triangle and 4 per vertex; linear except for the degree of the vertices.
class EdgeSides {
 public:
  struct Entry {
    Id high = 0, side = 0;
    friend auto operator<=>(const Entry&, const Entry&) = default;
  };

  // No triangle is degenerate. Throws ResourceError if 32 bits cannot count the sides.
  EdgeSides(std::span<const Triangle> triangles, std::size_t vertex_count);

  // Calls visit(low, high, entries) for each edge.
  template <class Visit>
  void for_each_edge(const Visit& visit) const {
    for (Id low = 0; low + 1 < first_.size(); ++low)
      for (std::size_t begin = first_[low], end = begin; begin < first_[low + 1]; begin = end) {
        while (end < first_[low + 1] && entries_[end].high == entries_[begin].high) ++end;
        visit(low, entries_[begin].high, std::span<const Entry>(entries_).subspan(begin, end - begin));
      }
  }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<Entry> entries_;
};

// The side across each side of a manifold, which runs the other way; no_id at a border.
[[nodiscard]] std::vector<Id> opposite_sides(std::span<const Triangle> triangles, std::size_t vertex_count);

}  // namespace lodestone::spherical
