// Nearest point on a triangle mesh, and where a ray meets it: a bounding volume hierarchy over the triangles in Morton
// order.
//
// Binary, boxes of both children in one node, at most four triangles per leaf; split where the Morton codes of the
// centres first differ (Karras 2012, sequentially). Boxes are float, rounded outwards; distances are double. About 45
// bytes per triangle; built in O(n log n), a query near the surface visits some tens of nodes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/box3.h"
#include "core/mesh/indexed_mesh.h"
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

  // Positions finite and of magnitudes whose squares a float's range holds (map them to about the unit cube first);
  // at least one triangle, at most 2^29; triangles may be degenerate. The arguments are copied.
  TriangleBvh(std::span<const Vec3d> positions, std::span<const Triangle> triangles);

  // hint: the slot of a triangle that may be near, which makes a query on coherent points several times faster.
  [[nodiscard]] Nearest nearest(Vec3d p, std::uint32_t hint = no_hint) const;
  // The least t >= least at which from + t * direction meets a triangle, infinity where it meets none; with any_will_do
  // some such t. Edges and corners belong to their triangles but for rounding; a triangle that the ray lies in is not
  // met.
  enum class Hit { first, any_will_do };
  [[nodiscard]] double meet(Vec3d from, Vec3d direction, double least, Hit hit = Hit::first) const;
  [[nodiscard]] std::uint32_t triangle(std::uint32_t slot) const { return original_[slot]; }

 private:
  // A child is a node number, or a leaf: top bit, number of the first slot, count - 1 in the low two bits.
  struct Node {
    Box3f box[2];
    std::uint32_t child[2]{};
  };
  struct Key {
    std::uint64_t morton = 0;
    std::uint32_t triangle = 0;
  };
  struct Subtree {
    Box3f box;
    std::uint32_t child = 0;
  };

  Subtree build(std::span<const Key> keys, std::uint32_t first, std::uint32_t end);
  void take_leaf(std::uint32_t leaf, Vec3d p, Nearest& best) const;
  void take_slot(std::uint32_t slot, Vec3d p, Nearest& best) const;
  [[nodiscard]] double meet_leaf(std::uint32_t leaf, Vec3d from, Vec3d direction, double least) const;

  std::vector<Node> nodes_;
  std::vector<Vec3d> positions_;         // in the order in which the slots first use them
  std::vector<Triangle> slots_;          // in Morton order
  std::vector<std::uint32_t> original_;  // number of each slot's triangle in the input
  Subtree root_;
};

}  // namespace lodestone
