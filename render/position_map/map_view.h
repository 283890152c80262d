// How a position map looks at a model: its views are made for a box, and checked, and say what their pixels see.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/math/vec3.h"

namespace lodestone {

// Parallel or central, in normalised model space, double precision.
enum class Projection : std::uint8_t { orthographic, perspective };

// The centre of pixel (x, y), row 0 on top, is (x + 1/2, y + 1/2) in window coordinates. The depth of a point is its
// distance from the eye along `forward`.
struct MapView {
  Projection projection = Projection::orthographic;
  Vec3d eye;                                             // orthographic: the centre of the picture at depth 0
  Vec3d right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};  // of unit length, pairwise perpendicular
  double pixel = 1.0 / 256;                              // side of a pixel; perspective: at depth 1
  int width = 0, height = 0;                             // pixels
  double nearest = 0;                                    // surfaces nearer than this depth are cut off; 0: none
  friend bool operator==(const MapView&, const MapView&) = default;

  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] double depth(Vec3d p) const { return dot(p - eye, forward); }
  // Side of a pixel at some depth: the spacing of samples on a surface that faces the view.
  [[nodiscard]] double spacing(double depth) const {
    return projection == Projection::perspective ? pixel * depth : pixel;
  }
};

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
