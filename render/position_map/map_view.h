// Views of position maps: made for a box, checked, and what their pixels see.
#pragma once

#include <string>

#include "core/math/vec3.h"
#include "render/position_map/position_map.h"

namespace lodestone {

struct WindowPoint {
  double x = 0, y = 0, depth = 0;
};
[[nodiscard]] inline WindowPoint to_window(const MapView& view, Vec3d p) {
  const Vec3d from_eye = p - view.eye;
  const double depth = dot(from_eye, view.forward), scale = 1 / view.spacing(depth);
  return {0.5 * view.width + scale * dot(from_eye, view.right), 0.5 * view.height - scale * dot(from_eye, view.up),
          depth};
}

// The view's nearest depth as a value that grows with depth and is linear in the window: depth, or -1/depth in
// perspective.
[[nodiscard]] inline double nearest_z(const MapView& view) {
  return view.projection == Projection::perspective ? -1 / view.nearest : view.nearest;
}

struct Ray {
  Vec3d origin, direction;  // direction: of depth 1 per unit, not of unit length
};
// Through a point of the window.
[[nodiscard]] inline Ray ray_through(const MapView& view, double x, double y) {
  const double u = (x - 0.5 * view.width) * view.pixel, v = (0.5 * view.height - y) * view.pixel;
  const Vec3d aside = u * view.right + v * view.up;
  if (view.projection == Projection::perspective) return {view.eye, view.forward + aside};
  return {view.eye + aside, view.forward};
}

// Towards the viewer, of unit length, from a point.
[[nodiscard]] Vec3d towards_eye(const MapView& view, Vec3d p);

// Looks along `forward` (of any length but 0) at a box from outside, upright as far as possible; just large enough for
// all of it and a margin of pixels. Throws InputError when that makes more than `largest_map_side` pixels a side.
inline constexpr int largest_map_side = 16384;
[[nodiscard]] MapView orthographic_view(const Box3f& box, Vec3d forward, double pixel, int margin = 2);

// From an eye outside of the box towards its centre, with pixels of side `pixel` there; likewise. Throws InputError,
// too, where the eye is so near that a corner of the box is not in front of it.
[[nodiscard]] MapView perspective_view(const Box3f& box, Vec3d eye, double pixel, int margin = 2);

// Throws InputError, naming `name`, for a view without pixels or with too many, of numbers that are not finite, of a
// pixel without size, or of directions that are not an orthonormal frame.
void check_view(const MapView& view, const std::string& name = "view");

}  // namespace lodestone
