// When triangles come in, and which vertices come in together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone::progressive {

// The first vertex of the group of each vertex: vertices of the base, and every other vertex with those right behind it
// of bit-equal position whose parents are one group, too.
[[nodiscard]] std::vector<std::uint32_t> group_starts(const ProgressiveMesh& mesh);

// A triangle is degenerate in levels of at most so many vertices; 0: in none. Of a triangle that is degenerate in the
// finest one, too, the number of vertices. About three steps, since two triangles go with a vertex of six.
[[nodiscard]] std::uint32_t birth(const Triangle& triangle, const ProgressiveMesh& mesh,
                                  const std::vector<std::uint32_t>& groups);

// Brings triangles into the order in which they come in; stable. `sorted` has room for all of them.
void sort_by_birth(std::span<const Triangle> triangles, std::span<const std::uint32_t> births, std::size_t vertex_count,
                   Triangle* sorted);
// In place, with the births found.
void sort_by_birth(ProgressiveMesh& mesh);

}  // namespace lodestone::progressive
