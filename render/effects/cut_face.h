// The cut of a solid by its clipping plane: what the plane opens is filled, so that one does not look into a shell.
//
// A point of the plane is inside the solid if the surface winds around it: of the triangles seen behind it, on the side
// that is kept, the numbers of fronts and backs differ. The rule of non-zero winding also holds for parts that overlap,
// hollow solids, and surfaces that face inwards. Backends count at the samples of the picture, where the surface covers
// them, so that the border of the cut is that of the surface.
//
// It is seen from the side that is cut away. It is lit as a plane, by the lights of its model but for shadows, and
// opaque: transparent models and those with masked or blended materials are left open. Overdraw does not count it.
#pragma once

#include <vector>

#include "render/frame/frame.h"

namespace lodestone::effects {

struct CutFace {
  const ModelFrame* model = nullptr;  // of the frame
  DepthOfPlane depth{};
  Vec3f colour{};  // in light, without fog
};

// The cuts that the frame's pictures may show.
[[nodiscard]] std::vector<CutFace> cut_faces(const Frame& frame);

// Its colour at a sample at depth z; x and y are in pixels from the upper left corner.
[[nodiscard]] Vec3f cut_colour(const CutFace& face, const Frame& frame, double x, double y, double z);

}  // namespace lodestone::effects
