// The level at which triangles become active, and the vertices that become active together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone::progressive {

// The first vertex of the group of each vertex: vertices of the base, and every other vertex with those directly after
// it of bit-equal position whose parents are one group, too.
[[nodiscard]] std::vector<std::uint32_t> group_starts(const ProgressiveMesh& mesh);

// The number of vertices up to which a triangle is degenerate; 0 if it never is; all vertices if it is degenerate in
// the finest level, too. About three steps, since two triangles go with a vertex of six.
[[nodiscard]] std::uint32_t activation_of(const Triangle& triangle, const ProgressiveMesh& mesh,
                                          const std::vector<std::uint32_t>& groups);

// Brings triangles into the order in which they become active; stable. `sorted` has room for all of them.
void sort_by_activation(std::span<const Triangle> triangles, std::span<const std::uint32_t> activations,
                        std::size_t vertex_count, Triangle* sorted);
// In place, with the activations computed.
void sort_by_activation(ProgressiveMesh& mesh);

}  // namespace lodestone::progressive
