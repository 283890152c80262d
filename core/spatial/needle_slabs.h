// Bounds of groups of needles that lie side by side, as around a hub: slabs across their mean direction.
//
// The box of such a group across the axes is as wide as the needles are long, so that thousands of boxes hold a point
// that one needle is near; a slab across them is as wide as the group.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/math/vec3.h"

namespace lodestone {

// Sums of unit vectors along needles and across their planes, of which only the lines count.
struct NeedleDirections {
  Vec3d along, normal;

  NeedleDirections() = default;
  explicit NeedleDirections(const std::array<Vec3d, 3>& corners);
  void add(const NeedleDirections& other);
};

// Two directions at right angles across the needles of a node, and the ranges of both of its children along each.
struct NeedleSlabs {
  Vec3f across[2];               // a little shorter than unit vectors: no distance along them is too large by rounding
  float lo[2][2]{}, hi[2][2]{};  // by child and direction

  NeedleSlabs() = default;  // says nothing
  explicit NeedleSlabs(const NeedleDirections& needles);
  // Each child is extended by its triangles before it is asked.
  void extend(int child, const std::array<Vec3d, 3>& corners);

  // Lower bounds of the squared distances of p from the children.
  [[nodiscard]] std::array<double, 2> squared_distances(Vec3d p) const {
    const double along[2] = {dot(to_double(across[0]), p), dot(to_double(across[1]), p)};
    const auto outside = [&](int child, int k) {
      return std::max(std::max(lo[child][k] - along[k], along[k] - hi[child][k]), 0.0);
    };
    const auto squared = [&](int child) {
      const double a = outside(child, 0), b = outside(child, 1);
      return a * a + b * b;
    };
    return {squared(0), squared(1)};
  }
};

// True if most neighbours in an order along the surface are nearly parallel: `count` triangles, corners_of(i) of each.
template <class CornersOf>
[[nodiscard]] bool are_side_by_side(std::uint32_t count, const CornersOf& corners_of) {
  constexpr double parallel = 0.99;  // cosine
  std::uint32_t parallels = 0;
  Vec3d before;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d along = NeedleDirections(corners_of(i)).along;
    parallels += std::abs(dot(before, along)) > parallel;
    before = along;
  }
  return 2 * parallels > count;
}

}  // namespace lodestone
