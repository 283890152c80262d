// Clipping of a triangle to the near and far planes and to the guard band (sutherland1974).
#pragma once

#include <array>
#include <span>

#include "render/backends/soft/viewport.h"

namespace lodestone::soft {

// A convex polygon: each of the six planes adds at most one corner to the triangle.
struct ClippedPolygon {
  std::array<ClipVertex, 9> corners;
  int count = 0;
  [[nodiscard]] std::span<const ClipVertex> view() const { return {corners.data(), static_cast<std::size_t>(count)}; }
};

// The part of the triangle inside -w <= z <= w and the viewport's guard band; fewer than three corners: nothing.
// The point where an edge leaves is the same bits from both triangles that share the edge.
[[nodiscard]] ClippedPolygon clip(const std::array<ClipVertex, 3>& triangle, const Viewport& viewport);

}  // namespace lodestone::soft
