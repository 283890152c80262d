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

// A half-edge in the list of its smaller vertex: the other vertex, and whether it runs towards that one.
[[nodiscard]] constexpr std::uint64_t half_edge_key(std::uint32_t larger, bool forward) {
  return std::uint64_t{larger} << 1 | std::uint64_t{forward};
}

// Adds the edges of which one vertex is the smaller one. Sorts its keys.
void count_edges_of_vertex(std::span<std::uint64_t> keys, EdgeCensus& census);

}  // namespace lodestone
