// The edges and handles of the input of a reconstruction, counted in one pass.
#pragma once

#include <cstddef>
#include <optional>

#include "core/mesh/edge_census.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Counts of vertices, not of their wedges, and without degenerate triangles.
struct Survey {
  EdgeCensus census;
  std::optional<std::size_t> handles;  // as count_handles() has them
};

// count_edges() and count_handles() from one list of the triangles around each vertex. Linear but for the degree of the
// vertices, which costs its square up to 256 and is sorted beyond; memory: 8 bytes per vertex and 12 per triangle, and
// as many again for copies of the triangles if there are wedges. A vertex in which fans meet, or of more than 256
// triangles, leaves the handles to count_handles().
[[nodiscard]] Survey survey(const IndexedMesh& mesh);

}  // namespace lodestone
