// Cracks of the levels of a progressive mesh, without the code that computes levels.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone {

// Edges that the boundary of a level (its oriented triangles, corners welded by the bits of their positions) has beyond
// the image of the input's boundary, and the other way: 0 when nothing cracks. A level: the first so many vertices.
[[nodiscard]] std::size_t residual_edges(const ProgressiveMesh& mesh, std::uint32_t vertices);

// The sum over so many levels between base and finest.
[[nodiscard]] std::size_t residual_edges_of_levels(const ProgressiveMesh& mesh, std::uint32_t levels);

}  // namespace lodestone
