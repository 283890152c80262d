// Clipping of a triangle to the near and far planes and to the guard band (sutherland1974), and the place of a pixel on
// a clipped one: few triangles have corners behind the eye or far outside the picture.
#pragma once

#include <array>
#include <span>

#include "render/backends/soft/raster_types.h"
#include "render/backends/soft/viewport.h"

namespace lodestone::soft {

// A convex polygon: each of the six planes, and one of the user's, adds at most one corner to the triangle.
struct ClippedPolygon {
  std::array<ClipVertex, 10> corners;
  int count = 0;
  [[nodiscard]] std::span<const ClipVertex> view() const { return {corners.data(), static_cast<std::size_t>(count)}; }
};

// The part of the triangle inside -w <= z <= w, the viewport's guard band and the clipping plane; fewer than three
// corners: nothing. The point where an edge leaves is the same bits from both triangles that share the edge.
[[nodiscard]] ClippedPolygon clip(const std::array<ClipVertex, 3>& triangle, const Viewport& viewport);

// Weights of the corners at a point in subpixels, perspective-correct, each in [0, 1], sum 1: interpolation in
// homogeneous coordinates (olano1997), which needs no clipping. Transforms the corners again.
[[nodiscard]] std::array<float, 3> clipped_weights(const DrawnCell& cell, const VertexIds& v, const Viewport& viewport,
                                                   SnappedPoint at);

// A vertex as the vertex stage, which has left its lambda, has drawn it.
[[nodiscard]] Vec3f drawn_position(const DrawnCell& cell, VertexId v);

// The corners before the division, by a projection of the model.
[[nodiscard]] std::array<ClipVertex, 3> clip_corners(const ViewProjection& projection, const DrawnCell& cell,
                                                     const VertexIds& v);

}  // namespace lodestone::soft
