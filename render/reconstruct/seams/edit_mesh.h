// A part of a triangle mesh that is being changed: the triangles around seams and holes.
//
// Vertices are indices into arrays that the caller holds; each knows the triangles around it, so that the triangle at a
// directed edge is found among a handful. The mesh is manifold along edges at all times: a directed edge belongs to one
// triangle at most, or add() refuses. Fans that only meet in a vertex are allowed, until they are split.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/triangle.h"

namespace lodestone {

class EditMesh {
 public:
  static constexpr std::uint32_t none = 0xFFFF'FFFFu;

  EditMesh() = default;
  // Takes triangles that are manifold along edges already.
  EditMesh(std::size_t vertices, std::vector<Triangle> triangles);

  [[nodiscard]] std::uint32_t add_vertex() {
    around_.emplace_back();
    return static_cast<std::uint32_t>(around_.size() - 1);
  }
  // The new triangle's number; none when two corners are equal or one of its directed edges is taken.
  std::uint32_t add(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void remove(std::uint32_t triangle);
  // The triangle has `to` where it had `from`; its directed edges must be free.
  void move_corner(std::uint32_t triangle, std::uint32_t from, std::uint32_t to);

  [[nodiscard]] std::size_t vertex_count() const { return around_.size(); }
  [[nodiscard]] std::size_t triangle_count() const { return triangles_.size(); }  // also removed ones
  [[nodiscard]] bool alive(std::uint32_t t) const { return triangles_[t].v[0] != none; }
  [[nodiscard]] const Triangle& triangle(std::uint32_t t) const { return triangles_[t]; }
  // Until the next add().
  [[nodiscard]] std::span<const std::uint32_t> around(std::uint32_t v) const {
    return {pool_.data() + around_[v].begin, around_[v].count};
  }

  // The triangle that runs from a to b; none without one.
  [[nodiscard]] std::uint32_t at(std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] bool is_border(std::uint32_t a, std::uint32_t b) const { return at(a, b) != none && at(b, a) == none; }
  // The corner of t that is neither a nor b.
  [[nodiscard]] std::uint32_t opposite(std::uint32_t t, std::uint32_t a, std::uint32_t b) const;

  // The triangles around v that are reached from one of them over edges that end in v.
  [[nodiscard]] std::vector<std::uint32_t> fan(std::uint32_t v, std::uint32_t first) const;

  // Gives v's fans, all but one, vertices of their own: new_vertex(fan) adds one and returns its number. Returns how
  // many.
  template <typename NewVertex>
  std::size_t part_fans(std::uint32_t v, NewVertex&& new_vertex) {
    std::size_t added = 0;
    for (; !around(v).empty(); ++added) {
      const std::vector<std::uint32_t> first = fan(v, around(v).front());
      if (first.size() == around(v).size()) break;
      const std::uint32_t own = new_vertex(first);
      for (const std::uint32_t t : first) move_corner(t, v, own);
    }
    return added;
  }

  // A gap at a vertex: between the border edge that leaves it and the one that arrives, going round outside of the
  // triangles of one fan.
  struct Gap {
    std::uint32_t next = none, previous = none;  // v -> next and previous -> v are border edges
  };
  [[nodiscard]] std::vector<Gap> gaps(std::uint32_t v) const;
  // The border edge that follows a -> b round the hole that it belongs to: b -> result. a -> b must be a border edge.
  [[nodiscard]] std::uint32_t next_on_border(std::uint32_t a, std::uint32_t b) const;

 private:
  // A piece of the pool; what has no room left moves to the pool's end.
  struct List {
    std::uint32_t begin = 0, count = 0, room = 0;
  };
  void drop(List& list, std::uint32_t triangle);
  void push(List& list, std::uint32_t triangle);

  std::vector<Triangle> triangles_;
  std::vector<List> around_;
  std::vector<std::uint32_t> pool_;
};

}  // namespace lodestone
