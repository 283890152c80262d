// From clip space to the window, one vertex at a time: the vertex stage does the same in lanes; clipping needs single
// ones.
#pragma once

#include "render/backends/soft/raster_types.h"
#include "render/frame/renderer.h"

namespace lodestone::soft {

// Before the division by w.
struct ClipVertex {
  float x = 0, y = 0, z = 0, w = 1;
  float kept = 1;  // distance from ModelFrame::clip, not negative on the side that is drawn
};

[[nodiscard]] ClipVertex to_clip(const ViewProjection& vp, Vec3f position);

// The viewport of one picture size.
class Viewport {
 public:
  explicit Viewport(ImageSize size);
  // Bits of Outside; 0: inside the view.
  [[nodiscard]] std::uint32_t outcode(const ClipVertex& v) const;
  // True for a vertex outside the near or far plane or the guard band: it must be clipped before it can be snapped.
  [[nodiscard]] bool needs_clipping(const ClipVertex& v) const;
  // Only for vertices that need no clipping. Coordinates are rounded to the nearest, ties to even.
  [[nodiscard]] WindowVertex snap(const ClipVertex& v) const;

  // |x| <= guard_x() w and |y| <= guard_y() w is the guard band.
  [[nodiscard]] float guard_x() const { return guard_x_; }
  [[nodiscard]] float guard_y() const { return guard_y_; }
  // Half the picture, in subpixels.
  [[nodiscard]] float half_width() const { return half_width_; }
  [[nodiscard]] float half_height() const { return half_height_; }

 private:
  float half_width_, half_height_;
  float guard_x_, guard_y_;
};

}  // namespace lodestone::soft
