// Splitting over-long edges, so that no edge of a mesh is longer than a limit.
//
// The length of an edge alone decides if it is split, at its middle: both sides do the same, so that no T-junction can
// arise, whatever the surface is like there (open, non-manifold, badly oriented). A triangle is split by those of its
// edges that are too long (red and green, as in bank1983):
//
//   three  four triangles by the three middles
//   two    the corner between them by both middles, and the rest by its shorter diagonal; by the one from the middle of
//          the edge that comes before that corner when they are equal
//   one    two triangles by the median
//
// and its parts in turn. This ends: halves are half as long; a median between two edges within the limit is within it,
// too; the shorter of two diagonals is at most sqrt(3)/2 of the shorter one of the two edges. So every round shortens
// the longest edge that is too long by at least 13 %.
//
// Middles are computed in double precision, where they are exact for all coordinates that matter, and rounded once, in
// the end, to float32 or to the lattice: before that the parts of a triangle tile it exactly. Vertices that coincide
// after rounding, also with one of the mesh, are one vertex; parts with two equal corners and repeated parts are
// dropped, as when a mesh is cleaned. Attributes are interpolated by halves, wedge by wedge, so that seams are kept.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// False when the lattice (or float32) is too coarse to split edges until they are so short: an edge of that length must
// be some of its steps long.
[[nodiscard]] bool can_refine(double longest, Lattice lattice);
// The limit for exact middles that keeps rounded ones within `longest`. Throws InputError unless can_refine().
[[nodiscard]] double refine_limit(double longest, Lattice lattice);

// Number of parts that refine_mesh() makes of the triangles, before parts that rounding makes equal are dropped; at
// most `most` + 1, where the count ends. Time is proportional to the result.
[[nodiscard]] std::uint64_t count_refined(const IndexedMesh& mesh, double longest, std::uint64_t most);

// Afterwards no edge is longer than `longest`. A triangle keeps its place in the order or is replaced by its first
// part; the other parts follow at the end. Throws InputError when no triangle is left: all had been without area.
// parallel/mesh/refine_mesh.h does the same with several workers.
RefineReport refine_mesh(IndexedMesh& mesh, double longest);

// The steps of refine_mesh, called in this order.
class EdgeSplitter {
 public:
  EdgeSplitter(IndexedMesh& mesh, double longest);

  // Triangles of [begin, end) with an edge beyond the limit, ascending.
  [[nodiscard]] std::vector<std::uint32_t> long_triangles(std::size_t begin, std::size_t end) const;
  // `triangles`: all of the above, ascending. The time is proportional to the number of parts.
  void split(std::span<const std::uint32_t> triangles);
  // A vertex of the mesh and a new one at the same position.
  struct Meeting {
    std::uint32_t vertex = 0, fresh = 0;
  };
  // Those of vertices [begin, end).
  [[nodiscard]] std::vector<Meeting> meetings(std::size_t begin, std::size_t end) const;
  // `meetings`: all of the above, by vertex, ascending. Called once.
  RefineReport finish(std::span<const Meeting> meetings);

 private:
  struct Part {
    Triangle triangle;
    std::uint32_t whole = 0;  // the mesh's triangle
  };
  [[nodiscard]] Vec3d place(std::uint32_t v) const {
    return v < first_fresh_ ? to_double(mesh_.positions[v]) : exact_[v - first_fresh_];
  }
  [[nodiscard]] bool is_long(std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] std::uint32_t middle(std::uint32_t a, std::uint32_t b);
  void add_attributes(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] std::uint32_t vertex_of(std::uint32_t v) const;
  void join(std::span<const Meeting> meetings);
  void drop_degenerate();
  void put_back();
  void drop_repeats(bool whole_mesh);
  void compact();

  IndexedMesh& mesh_;
  double limit2_;
  std::uint32_t first_fresh_;
  std::vector<Vec3d> exact_;                                          // of the new vertices
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;          // by the ends of an edge
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> at_;  // new vertices by a hash of their position
  std::vector<Part> parts_;                                           // by triangle of the mesh
  RefineReport report_;
};

}  // namespace lodestone
