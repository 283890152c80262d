// A triangle mesh of any size under half-edge collapses, as one ring of neighbours per vertex.
//
// The compact rings of core/simplify/quadric/quadric_kernel.h hold a block of 65,000 vertices; these hold a whole mesh,
// and know wedges. A collapse reads and writes the rings of the vertex, of its target and of their neighbours only, so
// that regions of vertices may collapse side by side as long as nothing moves whose ring leaves its region.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/math/lanes/aligned_point.h"
#include "core/mesh/indexed_mesh.h"
#include "core/progressive/collapse/ring.h"

namespace lodestone::progressive {

// A collapse {v, u} -> u in terms of the two rings, and the destinations of the wedges of v.
struct Collapse {
  Id vertex = no_id, target = no_id;
  std::uint32_t at = 0, back = 0;  // of the target in the ring of the vertex, of the vertex in that of the target
  // The wedges of the vertex in the triangles on both sides of the edge, and those of the target they go to; at a
  // border of the surface both are the same.
  Id wedge[2] = {no_id, no_id}, wedge_target[2] = {no_id, no_id};
};

// Orders the triangles at a vertex, given by the next corner and the one after it, around the vertex, and returns their
// shape. In a closed fan the first of the input comes first.
enum class Shape : std::uint8_t { closed, open, several };  // several: not a single fan; the order is undefined
using ChainFan = Shape (*)(const Id* start, const Id* end, std::uint32_t count, std::uint8_t* order);
inline constexpr std::uint32_t most_chained = 32;
// At most most_chained triangles.
[[nodiscard]] Shape chain_fan(const Id* start, const Id* end, std::uint32_t count, std::uint8_t* order);

// The order, given the triangle after each (32: none) and the set of those that have one before them.
[[nodiscard]] inline Shape follow_fan(const std::uint8_t* next, std::uint32_t has_before, std::uint32_t n,
                                      std::uint8_t* order) {
  const std::uint32_t all = 0xffff'ffffu >> (32 - n);
  const bool closed = has_before == all;
  const auto first = static_cast<std::uint32_t>(closed ? 0 : std::countr_one(has_before));
  std::uint32_t length = 0, at = first;
  do {
    order[length++] = static_cast<std::uint8_t>(at);
    at = next[at];
  } while (at < 32 && at != first && length < n);
  return length < n ? Shape::several : closed ? Shape::closed : Shape::open;
}

// Vertices are the mesh's positions; with wedges, a vertex has the number of its first wedge. Where more than two
// triangles meet at an edge, triangles turn against each other or fans touch in a vertex, the surface is cut: a vertex
// has one fan, and further fans get copies of the vertex with new numbers at the end.
class RingMesh {
 public:
  explicit RingMesh(const IndexedMesh& mesh);  // which must outlive it
  RingMesh(const RingMesh&) = delete;
  RingMesh& operator=(const RingMesh&) = delete;

  // The steps of setting up, in this order; make_rings may run side by side, for all vertices of the mesh, each call
  // with an arena that lives as long as the rings. `chain` serves fans of at most eight triangles.
  void list_corners();
  void make_rings(std::size_t begin, std::size_t end, RingArena& arena, ChainFan chain = chain_fan);
  void cut_open();
  // Frees the rings and points, when no ring is needed any more; numbers, wedges and corners remain.
  void free_rings() { rings_.reset(), points_.reset(), arena_ = {}; }

  // Includes copies and unused numbers.
  [[nodiscard]] std::size_t vertex_count() const { return input_vertices() + copy_source_.size(); }
  [[nodiscard]] std::size_t input_vertices() const { return input_->positions.size(); }
  [[nodiscard]] bool is_used(Id v) const { return rings_[v].size > 0; }
  [[nodiscard]] bool has_wedges() const { return has_wedges_; }
  [[nodiscard]] const Ring& ring(Id v) const { return rings_[v]; }
  [[nodiscard]] Vec3f position(Id v) const { return {points_[v].x, points_[v].y, points_[v].z}; }
  [[nodiscard]] const AlignedPoint* points() const { return points_.get(); }
  // The vertex or wedge of the mesh that a vertex or wedge equals, or is a copy of.
  [[nodiscard]] Id source_of(Id id) const { return id < input_vertices() ? id : copy_source_[id - input_vertices()]; }
  // The triangles, with corners on copies where the surface was cut; wedges, if there are any.
  [[nodiscard]] std::span<const Triangle> corners() const { return corners_.empty() ? input_->triangles : corners_; }
  // The vertex of a wedge.
  [[nodiscard]] Id vertex_of(Id wedge) const {
    if (wedge >= input_vertices()) return copy_vertex_[wedge - input_vertices()];
    return has_wedges_ ? input_->wedges.vertex[wedge] : wedge;
  }
  // The vertex of the mesh that a vertex is, or is a copy of.
  [[nodiscard]] Id original_of(Id v) const { return vertex_of(source_of(v)); }
  // The numbers of the copies of a vertex of the mesh, and of their wedges: from the first to before the second.
  [[nodiscard]] std::pair<Id, Id> copies_of(Id original) const;
  // True for a vertex all of whose triangles have its own number as their wedge.
  [[nodiscard]] bool has_one_wedge(Id v) const;
  [[nodiscard]] std::size_t cut_vertices() const { return cut_vertices_; }
  [[nodiscard]] std::size_t cut_edges() const { return cut_edges_; }

  // Fills in the collapse and says whether the surface allows it: the link condition (dey1999) keeps a manifold and its
  // borders; each wedge of v has a wedge of u to go to across the triangles at the edge, which keeps seams on seams and
  // charts in one piece; no chart, component or border shrinks away.
  [[nodiscard]] bool allows(Collapse& collapse) const;
  // The part of it about wedges, with `at` and `back` filled in.
  [[nodiscard]] bool allows_wedges(Collapse& collapse) const;
  // Only the destinations of the wedges, for attributes: fills in the collapse; false if one has no destination.
  [[nodiscard]] bool follows_wedges(Collapse& collapse) const;
  // The wedge of x in its triangle with `next`, one ring place on; x itself without wedges.
  [[nodiscard]] Id wedge_of(Id x, Id next) const { return has_wedges_ ? rings_[x].wedge(rings_[x].find(next)) : x; }
  // Carries out a collapse; `arena` serves rings that grow. Returns the number of triangles that vanish, 1 or 2.
  int apply(const Collapse& collapse, RingArena& arena);
  // Undoes the collapse of a vertex that had `size` neighbours, where the rings of these are as that collapse left
  // them, but for their first place. For closed fans without wedges. Touches those rings alone.
  void undo(Id vertex, Id target, std::uint32_t size, RingArena& arena);

 private:
  struct Cut {
    Id vertex = 0;
    std::uint32_t begin = 0, end = 0;  // of the fan's corners in by_vertex_
    bool open = false;
  };
  // Corners are numbered 4 * triangle + place.
  // The next one of its triangle and the one before, without a branch, since no place can be predicted.
  static std::uint32_t after(std::uint32_t corner) { return corner + 1 - (corner >> 1 & 1) * 3; }
  static std::uint32_t before(std::uint32_t corner) { return corner + 2 - ((corner >> 1 | corner) & 1) * 3; }
  [[nodiscard]] Id corner_id(std::uint32_t corner) const { return corners()[corner / 4].v[corner % 4]; }
  [[nodiscard]] Id position_id(std::uint32_t corner) const {  // as in the input, without copies
    const Id wedge = input_->triangles[corner / 4].v[corner % 4];
    return has_wedges_ ? input_->wedges.vertex[wedge] : wedge;
  }
  [[nodiscard]] Id start_of(std::uint32_t corner) const { return position_id(after(corner)); }
  [[nodiscard]] Id end_of(std::uint32_t corner) const { return position_id(before(corner)); }
  [[nodiscard]] bool make_simple_ring(Id v, std::span<const std::uint32_t> corners, RingArena& arena, ChainFan chain);
  void chain_any(Id vertex, std::vector<Cut>& cuts);
  void copy_fan(const Cut& cut);
  void make_room();
  void name_copy(const Cut& cut);
  void make_ring(Id v, std::span<const std::uint32_t> corners, bool open, RingArena& arena);
  Ring& begin_ring(Id v, std::uint32_t corners, bool open, RingArena& arena);
  [[nodiscard]] bool keeps_surface(const Collapse& collapse) const;
  [[nodiscard]] bool maps_wedges(Collapse& collapse) const;
  [[nodiscard]] bool keeps_charts(const Collapse& collapse) const;
  [[nodiscard]] bool is_seam(Id v, std::uint32_t k) const;
  void splice(const Collapse& collapse, RingArena& arena);
  static void splice_own(Ring& u, const Ring& v, std::uint32_t back, std::uint32_t first, std::uint32_t between);
  void grow(Ring& ring, std::uint32_t size, RingArena& arena) const;
  void remove(Id from, Id gone, Id stays);
  void insert(Ring& ring, std::uint32_t at, Id id, RingArena& arena) const;

  const IndexedMesh* input_;
  bool has_wedges_ = false;
  std::vector<Triangle> corners_;  // empty: those of the input, as long as nothing is cut
  // With room for some copies, which grows if there are more. One more after the last, since lanes reach beyond a
  // ring.
  std::size_t room_ = 0;
  std::unique_ptr<Ring[]> rings_;
  std::unique_ptr<AlignedPoint[]> points_;
  RingArena arena_;  // of fans that were cut apart
  std::vector<Id> copy_source_, copy_vertex_;
  std::size_t cut_vertices_ = 0, cut_edges_ = 0;

  // While setting up: corners by vertex, and which vertices have other than a single fan.
  std::vector<std::uint32_t> first_;
  std::unique_ptr<std::uint32_t[]> by_vertex_;
  std::vector<std::uint8_t> several_;
  [[nodiscard]] std::span<std::uint32_t> corners_of(std::size_t v) const {
    return {by_vertex_.get() + first_[v], first_[v + 1] - first_[v]};
  }
};

}  // namespace lodestone::progressive
