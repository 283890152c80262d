// A part of a triangle mesh that is being changed: the triangles around seams and holes.
//
// Vertices are indices into arrays that the caller holds; each knows the triangles around it, so that the triangle at a
// directed edge is found among a handful. The mesh is manifold along edges at all times: a directed edge belongs to one
// triangle at most, or add() refuses. Fans that only meet in a vertex are allowed, until they are split.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/id.h"
#include "core/math/vec3.h"

namespace lodestone {

class EditMesh {
 public:
  static constexpr TriangleId none{0xFFFF'FFFFu};
  static constexpr VertexId no_vertex{0xFFFF'FFFFu};

  EditMesh() = default;
  // Takes triangles that are manifold along edges already.
  EditMesh(std::size_t vertices, std::vector<Triangle> triangles);

  [[nodiscard]] VertexId add_vertex() {
    around_.emplace_back();
    return VertexId(around_.size() - 1);
  }
  // The new triangle; none when two corners are equal or one of its directed edges is taken.
  TriangleId add(VertexId a, VertexId b, VertexId c);
  void remove(TriangleId triangle);
  // The triangle has `to` where it had `from`; its directed edges must be free.
  void move_corner(TriangleId triangle, VertexId from, VertexId to);

  [[nodiscard]] std::size_t vertex_count() const { return around_.size(); }
  [[nodiscard]] std::size_t triangle_count() const { return triangles_.size(); }  // also removed ones
  [[nodiscard]] bool alive(TriangleId t) const { return triangles_[t].v[0] != no_vertex; }
  [[nodiscard]] const Triangle& triangle(TriangleId t) const { return triangles_[t]; }
  [[nodiscard]] std::array<VertexId, 3> corners(TriangleId t) const {
    const auto& v = triangles_[t].v;
    return {VertexId(v[0]), VertexId(v[1]), VertexId(v[2])};
  }
  // Until the next add().
  [[nodiscard]] std::span<const TriangleId> around(VertexId v) const {
    return {pool_.data() + around_[v].begin, around_[v].count};
  }

  // The triangle that runs from a to b; none without one.
  [[nodiscard]] TriangleId at(VertexId a, VertexId b) const;
  [[nodiscard]] bool is_border(VertexId a, VertexId b) const { return at(a, b) != none && at(b, a) == none; }
  // The corner of t that is neither a nor b.
  [[nodiscard]] VertexId opposite(TriangleId t, VertexId a, VertexId b) const;

  // The triangles around v that are reached from one of them over edges that end in v.
  [[nodiscard]] std::vector<TriangleId> fan(VertexId v, TriangleId first) const;

  // Gives v's fans, all but one, vertices of their own: new_vertex(fan) adds one and returns it. Returns how
  // many.
  template <typename NewVertex>
  std::size_t part_fans(VertexId v, NewVertex&& new_vertex) {
    std::size_t added = 0;
    for (; !around(v).empty(); ++added) {
      const std::vector<TriangleId> first = fan(v, around(v).front());
      if (first.size() == around(v).size()) break;
      const VertexId own = new_vertex(first);
      for (const TriangleId t : first) move_corner(t, v, own);
    }
    return added;
  }

  // A gap at a vertex: between the border edge that leaves it and the one that arrives, going round outside of the
  // triangles of one fan.
  struct Gap {
    VertexId next = no_vertex, previous = no_vertex;  // v -> next and previous -> v are border edges
  };
  [[nodiscard]] std::vector<Gap> gaps(VertexId v) const;
  // The border edge that follows a -> b round the hole that it belongs to: b -> result. a -> b must be a border edge.
  [[nodiscard]] VertexId next_on_border(VertexId a, VertexId b) const;

 private:
  // A piece of the pool; what has no room left moves to the pool's end.
  struct List {
    std::uint32_t begin = 0, count = 0, room = 0;
  };
  void drop(List& list, TriangleId triangle);
  void push(List& list, TriangleId triangle);

  std::vector<Triangle> triangles_;
  std::vector<List> around_;
  std::vector<TriangleId> pool_;
};

}  // namespace lodestone
