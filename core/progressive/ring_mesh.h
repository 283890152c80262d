// A triangle mesh of any size under half-edge collapses, as one ring of neighbours per vertex.
//
// The compact rings of core/simplify/quadric_kernel.h hold a block of 65,000 vertices; these hold a whole mesh, and
// know wedges. A collapse reads and writes the rings of the vertex, of its target and of their neighbours only, so that
// regions of vertices may collapse side by side as long as nothing moves whose ring leaves its region.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/mesh/indexed_mesh.h"

namespace lodestone::progressive {

using Id = std::uint32_t;
inline constexpr Id no_id = 0xffff'ffffu;

// The neighbours of a vertex in order: its triangles are (vertex, ids[k], ids[k + 1]), closed rings wrap around.
// Triangle k is *sector* k. Where vertices have wedges, ids[capacity + k] is the wedge of the vertex in sector k.
struct Ring {
  Id* ids = nullptr;
  std::uint32_t size = 0;
  std::uint32_t capacity : 31 = 0, open : 1 = 0;

  [[nodiscard]] std::uint32_t next(std::uint32_t k) const { return k + 1 < size ? k + 1 : 0; }
  [[nodiscard]] std::uint32_t previous(std::uint32_t k) const { return k > 0 ? k - 1 : size - 1; }
  [[nodiscard]] std::uint32_t sectors() const { return size - open; }
  [[nodiscard]] std::uint32_t find(Id id) const {
    std::uint32_t k = 0;
    while (k < size && ids[k] != id) ++k;
    return k;
  }
  [[nodiscard]] Id& wedge(std::uint32_t k) const { return ids[capacity + k]; }
  [[nodiscard]] std::span<const Id> neighbours() const { return {ids, size}; }
};

// Memory for rings that outgrow their place. One per worker at a time; given back with the mesh.
class RingArena {
 public:
  [[nodiscard]] Id* take(std::size_t count);

 private:
  std::vector<std::unique_ptr<Id[]>> chunks_;
  Id* next_ = nullptr;
  std::size_t left_ = 0;
};

// A collapse {v, u} -> u in terms of the two rings, and what becomes of the wedges of v.
struct Collapse {
  Id vertex = no_id, target = no_id;
  std::uint32_t at = 0, back = 0;  // of the target in the ring of the vertex, of the vertex in that of the target
  // The wedges of the vertex in the triangles on both sides of the edge, and those of the target they go to; at a
  // border of the surface both are the same.
  Id wedge[2] = {no_id, no_id}, wedge_target[2] = {no_id, no_id};
};

// Vertices are the mesh's positions; with wedges, a vertex has the number of its first wedge. Where more than two
// triangles meet at an edge, triangles turn against each other or fans touch in a vertex, the surface is cut: a vertex
// has one fan, and further fans get copies of the vertex, numbered behind.
class RingMesh {
 public:
  explicit RingMesh(const IndexedMesh& mesh);  // which has to stay alive
  RingMesh(const RingMesh&) = delete;
  RingMesh& operator=(const RingMesh&) = delete;

  // The steps of setting up, in this order; those with a range may run side by side, for all vertices of the mesh.
  void list_corners();
  void find_fans(std::size_t begin, std::size_t end);
  void cut_open();
  void make_rings(std::size_t begin, std::size_t end);
  void finish_rings();

  [[nodiscard]] std::size_t vertex_count() const { return rings_.size(); }  // with copies, and with unused numbers
  [[nodiscard]] std::size_t input_vertices() const { return input_->positions.size(); }
  [[nodiscard]] bool is_used(Id v) const { return rings_[v].size > 0; }
  [[nodiscard]] bool has_wedges() const { return has_wedges_; }
  [[nodiscard]] const Ring& ring(Id v) const { return rings_[v]; }
  [[nodiscard]] Vec3f position(Id v) const { return positions_[v]; }
  // The vertex or wedge of the mesh that a vertex or wedge is, or is a copy of.
  [[nodiscard]] Id source_of(Id id) const { return id < input_vertices() ? id : copy_source_[id - input_vertices()]; }
  // With its corners on copies where the surface was cut; wedges, if there are any.
  [[nodiscard]] const std::vector<Triangle>& corners() const { return corners_; }
  // The vertex of a wedge.
  [[nodiscard]] Id vertex_of(Id wedge) const;
  [[nodiscard]] std::size_t cut_vertices() const { return cut_vertices_; }
  [[nodiscard]] std::size_t cut_edges() const { return cut_edges_; }

  // Fills in the collapse and says whether the surface allows it: the link condition (dey1999) keeps a manifold and its
  // borders; each wedge of v has a wedge of u to go to across the triangles at the edge, which keeps seams on seams and
  // charts in one piece; no chart, component or border shrinks away.
  [[nodiscard]] bool allows(Collapse& collapse) const;
  // Only the wedges, which tell attributes what they go to: fills in the collapse, false when one has nowhere to go.
  [[nodiscard]] bool follows_wedges(Collapse& collapse) const;
  // The wedge of x in its triangle with `next`, one ring place on; x itself without wedges.
  [[nodiscard]] Id wedge_of(Id x, Id next) const { return has_wedges_ ? rings_[x].wedge(rings_[x].find(next)) : x; }
  // Carries it out; `arena` serves rings that grow. Returns the triangles that vanish, 1 or 2.
  int apply(const Collapse& collapse, RingArena& arena);

 private:
  enum class Shape : std::uint8_t { closed, open, several };
  struct Cut {
    Id vertex = 0;
    std::uint32_t begin = 0, end = 0;  // of the fan's corners in by_vertex_
    bool open = false;
  };
  [[nodiscard]] Id position_id(std::uint32_t corner) const;
  [[nodiscard]] Id start_of(std::uint32_t corner) const { return position_id(corner - corner % 3 + (corner + 1) % 3); }
  [[nodiscard]] Id end_of(std::uint32_t corner) const { return position_id(corner - corner % 3 + (corner + 2) % 3); }
  [[nodiscard]] Id& corner_id(std::uint32_t corner) { return corners_[corner / 3].v[corner % 3]; }
  [[nodiscard]] Shape chain_simply(std::span<std::uint32_t> corners) const;
  void chain_any(Id vertex, std::vector<Cut>& cuts);
  void copy_fan(const Cut& cut);
  void make_ring(Id v, std::span<const std::uint32_t> corners, bool open, Id* place);
  [[nodiscard]] bool keeps_surface(const Collapse& collapse) const;
  [[nodiscard]] bool maps_wedges(Collapse& collapse) const;
  [[nodiscard]] bool keeps_charts(const Collapse& collapse) const;
  [[nodiscard]] bool is_seam(Id v, std::uint32_t k) const;
  void splice(const Collapse& collapse, RingArena& arena);
  void grow(Ring& ring, std::uint32_t size, RingArena& arena) const;
  void remove(Id from, Id gone, Id stays);

  const IndexedMesh* input_;
  bool has_wedges_ = false;
  std::vector<Triangle> corners_;
  std::vector<Ring> rings_;
  std::vector<Id> store_;  // of the rings as they are at first
  RingArena arena_;        // of those of fans that were cut apart
  const Vec3f* positions_;
  std::vector<Vec3f> own_positions_;  // where there are copies
  std::vector<Id> copy_source_, copy_vertex_;
  std::size_t cut_vertices_ = 0, cut_edges_ = 0;

  // While setting up: corners (3 * triangle + place) by vertex, in the order of their fan.
  std::vector<std::uint32_t> first_, by_vertex_;
  std::vector<Shape> shape_;
  std::vector<Cut> cuts_;  // the fans of vertices that have several
};

}  // namespace lodestone::progressive
