// What the edges of a surface are like: borders, edges of more than two triangles, neighbours that face against each
// other. Simplifiers hold such edges fixed or move them with care, so a mesh that has many of them stays large.
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Every edge, an unordered pair of vertices that some triangle joins, counts once.
struct EdgeCensus {
  std::uint64_t edges = 0;
  std::uint64_t border = 0;        // one triangle
  std::uint64_t non_manifold = 0;  // three triangles or more
  std::uint64_t inconsistent = 0;  // two triangles that run along it in the same direction: one of them faces backwards
  friend bool operator==(const EdgeCensus&, const EdgeCensus&) = default;
};

// Of triangles with three distinct ids below `vertex_count`. A counting sort of the half-edges by their smaller vertex,
// then by the other one: linear but for the degree of the vertices. Memory: 4 bytes per vertex and 24 per triangle.
// Throws ResourceError when 3 T half-edges are more than 32 bits count.
[[nodiscard]] EdgeCensus count_edges(std::span<const Triangle> triangles, std::size_t vertex_count);

}  // namespace lodestone
