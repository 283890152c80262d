// Distance of the drawn from the full surface on the screen, which --pixel-error bounds.
//
// Points of either surface inside the picture are taken to the nearest point of the other one; both are projected, and
// the distance of the two in the picture counts. Points of the drawn surface are its vertices and the centres of its
// triangles, those of the full one its vertices. Points that are nearer than positions are exact
// (position_resolution.h) have no distance.
#pragma once

#include <cstdint>

#include "core/spatial/triangle_bvh.h"
#include "parallel/scheduler/scheduler.h"
#include "render/camera/camera.h"
#include "render/lod/morph.h"
#include "render/lod/selection.h"

namespace lodestone {

struct ScreenError {
  double drawn_to_full = 0, full_to_drawn = 0;  // largest, pixels
  std::uint64_t points = 0;                     // looked at
  [[nodiscard]] double largest() const { return drawn_to_full > full_to_drawn ? drawn_to_full : full_to_drawn; }
};

// The full surface M_L, for any number of frames: about 100 bytes per triangle.
class ScreenErrorBasis {
 public:
  explicit ScreenErrorBasis(const Hierarchy& hierarchy);
  [[nodiscard]] const TriangleBvh& full() const { return full_; }

 private:
  TriangleBvh full_;
};

// `selection` is a whole partition (keep_culled = true). O(drawn and full triangles in sight) nearest-point queries,
// and a bounding volume hierarchy of the drawn surface.
[[nodiscard]] ScreenError screen_error(const MorphContext& morph, const Selection& selection,
                                       const ViewProjection& view_projection, ImageSize size,
                                       const ScreenErrorBasis& basis, Scheduler& scheduler);

}  // namespace lodestone
