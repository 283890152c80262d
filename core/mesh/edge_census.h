// Counts kinds of edges: borders, edges of more than two triangles, neighbours with opposite orientations. Simplifiers
// keep such edges fixed or move them with care, so a mesh with many of them remains large.
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Every edge, an unordered pair of vertices of a triangle, counts once.
struct EdgeCensus {
  std::uint64_t edges = 0;
  std::uint64_t border = 0;        // one triangle
  std::uint64_t non_manifold = 0;  // three triangles or more
  std::uint64_t inconsistent = 0;  // two triangles that use it in the same direction: one of them faces backwards
  friend bool operator==(const EdgeCensus&, const EdgeCensus&) = default;
};

// The triangles have three distinct ids below `vertex_count`. A counting sort of the half-edges by their smaller
// vertex, then by the other one: linear except for the degree of the vertices. Memory: 4 bytes per vertex and 24 per
// triangle. Throws ResourceError if 32 bits cannot count the half-edges.
[[nodiscard]] EdgeCensus count_edges(std::span<const Triangle> triangles, std::size_t vertex_count);

}  // namespace lodestone
