// Cuts polygons that are not convex into triangles within themselves.
//
// Ear clipping (meisters1975): a corner may go whose triangle no other corner enters. All decisions are exact
// (core/math/orientation.h); a grid finds the corners that may lie in a triangle, so that n corners take about n log n.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone {

// Triangles of corner numbers, n - 2 of them, turned as the polygon is.
//
// Empty if the fan around corner 0 is right, because it does not fold, as that of a convex polygon never does, or
// because no cut is better: the polygon has no area, or a corner that is not finite. A polygon that touches itself, as
// where a double edge joins a hole to the outline, is cut without overlap. One that crosses itself is cut somehow. One
// that is not planar is cut as its shadow is, along the axis that sees most of it.
[[nodiscard]] std::vector<Triangle> cut_polygon(std::span<const Vec3d> polygon);

// Polygons of equally many corners, one after the other, as fans among other triangles.
struct FanRun {
  std::size_t first = 0;  // triangle
  std::size_t polygons = 0, corners = 0;
  [[nodiscard]] std::size_t end() const { return first + polygons * (corners - 2); }
};

// Replaces fans by better cuts, where there are any. `values`: lists as long as `triangles` of what else the corners
// have; they follow.
void cut_fans(std::span<const Vec3d> positions, std::span<const FanRun> runs, std::span<Triangle> triangles,
              std::span<const std::span<Triangle>> values = {});

}  // namespace lodestone
