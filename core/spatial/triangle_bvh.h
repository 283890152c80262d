// Nearest point on a triangle mesh, and intersection of rays with it: a BoxTree over the triangles in Morton order.
// About 50 bytes per triangle (100 more while it is built), up to 600 where most of them are needles that cross each
// other (core/spatial/part_boxes.h) and 250 where these lie side by side (core/spatial/needle_slabs.h); built in O(n
// log n), a query near the surface visits some tens of nodes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "core/spatial/box_tree.h"
#include "core/spatial/point_triangle.h"

namespace lodestone {

class TriangleBvh {
 public:
  static constexpr std::uint32_t no_hint = 0xffff'ffffu;

  struct Nearest {
    Vec3d point;
    double squared_distance = 0;
    std::uint32_t slot = 0;  // the triangle, as a hint for a query nearby; triangle(slot) is its number in the input
  };

  // Positions are finite, with squares in the range of float (map them to about the unit cube first); at least one
  // triangle, at most 2^29; triangles may be degenerate. The arguments are copied.
  TriangleBvh(std::span<const Vec3d> positions, std::span<const Triangle> triangles);

  // The search ends at a distance of 3e-16 or less. hint: the slot of a triangle that may be near, which makes a query
  // on coherent points several times faster.
  [[nodiscard]] Nearest nearest(Vec3d p, std::uint32_t hint = no_hint) const;
  // The minimum t >= least at which from + t * direction meets a triangle, infinity if it meets none; with any_will_do
  // any such t. Edges and corners belong to their triangles except for rounding; a triangle in whose plane the ray lies
  // is not met.
  enum class Hit { first, any_will_do };
  [[nodiscard]] double meet(Vec3d from, Vec3d direction, double least, Hit hit = Hit::first) const;
  [[nodiscard]] std::uint32_t triangle(std::uint32_t slot) const { return triangle_of_[slot]; }

 private:
  void add_slot(const Triangle& triangle, std::span<const Vec3d> positions, std::vector<std::uint32_t>& renumbered);
  void take_slot(std::uint32_t slot, Vec3d p, Nearest& best) const;

  std::vector<Vec3d> positions_;  // in the order in which the slots first use them
  std::vector<Triangle> slots_;   // in Morton order, a long triangle once for each of its parts
  std::vector<std::uint32_t> triangle_of_;
  BoxTree tree_;
};

}  // namespace lodestone
