// The triangles of vertices whose star is not a fan, while half-edges collapse.
//
// A ring says everything about a fan. Where surfaces touch or meet in an edge, or neighbours disagree on what is
// outside, a vertex is *nonmanifold*: its ring is only the set of its neighbours, and its triangles are listed here.
// Such vertices are few, so that nothing here is fast; and nothing is inline, since the kernel for one processor must
// not compile code that others could be given by the linker.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/simplify/quadric/block_arrays.h"

namespace lodestone::quadric {

class NonmanifoldStars {
 public:
  using Edge = Link::Edge;  // of a triangle at the vertex: the two other corners, in order

  // Lists the triangles of all nonmanifold vertices of a block whose rings are made. If none of them may move there is
  // nothing to follow, and the list remains empty.
  void reset(const SimplifyInput& input, const Arrays& arrays, bool any_movable);
  [[nodiscard]] bool empty() const { return lists_ == 0; }
  [[nodiscard]] bool contains(Id v) const { return !empty() && list_of_[v] != no_list; }
  [[nodiscard]] std::span<const Edge> triangles(Id v) const { return list_[list_of_[v]]; }

  // The number of triangles of v with u; v is listed.
  [[nodiscard]] unsigned uses(Id v, Id u) const;
  // The lanes of the neighbours whose triangles with v all have the same third corner: the border of one surface, even
  // if its triangles are doubled.
  [[nodiscard]] unsigned border_lanes(Id v, const Ring& ring, unsigned degree) const;
  // True if one of its triangles has both other corners, in any order.
  [[nodiscard]] bool has_triangle(Id v, Id a, Id b) const;

  // A bound of the squared distance of a point from the triangles of v, rounded up; infinite if v has lost them all.
  [[nodiscard]] float squared_distance(Id v, Vec3f point, const AlignedPoint* points) const;

  // Lists a vertex, without triangles; drops one that has become a fan.
  void begin(Id v);
  void forget(Id v) { list_of_[v] = no_list; }

  void add(Id v, Edge e);
  void replace(Id v, Id from, Id to);
  void remove(Id v, Id u);        // all triangles with u
  void remove(Id v, Id a, Id b);  // those with both

 private:
  static constexpr std::uint32_t no_list = 0xffff'ffffu;
  std::vector<std::uint32_t> list_of_;
  std::vector<std::vector<Edge>> list_;  // the first lists_ are in use; the others keep their memory
  std::size_t lists_ = 0;
};

}  // namespace lodestone::quadric
