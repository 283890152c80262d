// The place of a pixel on a triangle, for the few triangles that have corners behind the eye or far outside the
// picture.
#pragma once

#include <array>

#include "render/backends/soft/raster_types.h"
#include "render/backends/soft/viewport.h"

namespace lodestone::soft {

// Weights of the corners at a point in subpixels, perspective-correct, each in [0, 1], sum 1: interpolation in
// homogeneous coordinates (olano1997), which needs no clipping. Morphs and transforms the corners again.
[[nodiscard]] std::array<float, 3> clipped_weights(const DrawnCell& cell, const VertexIds& v, const Viewport& viewport,
                                                   SnappedPoint at);

// The corners before the division, by a projection of the model.
[[nodiscard]] std::array<ClipVertex, 3> clip_corners(const ViewProjection& projection, const DrawnCell& cell,
                                                     const VertexIds& v);

}  // namespace lodestone::soft
