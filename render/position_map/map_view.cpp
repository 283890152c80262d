#include "render/position_map/map_view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "render/position_map/position_map.h"

namespace lodestone {
namespace {

Vec3d normalised(Vec3d v) { return (1 / length(v)) * v; }

std::array<Vec3d, 8> corners_of(const Box3f& box) {
  std::array<Vec3d, 8> corners;
  for (unsigned k = 0; k < 8; ++k)
    corners[k] =
        to_double(Vec3f{k & 1 ? box.hi.x : box.lo.x, k & 2 ? box.hi.y : box.lo.y, k & 4 ? box.hi.z : box.lo.z});
  return corners;
}

// A frame that looks along `forward`: z is up, or y where that is the direction of view.
void aim(MapView& view, Vec3d forward) {
  view.forward = normalised(forward);
  const Vec3d upright = std::abs(view.forward.z) < 0.999 ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
  view.right = normalised(cross(view.forward, upright));
  view.up = cross(view.right, view.forward);
}

int side_for(double extent, int margin) {
  const double pixels = std::ceil(extent) + 2.0 * margin;
  if (!(pixels <= largest_map_side))
    throw InputError(describe("view", "",
                              "a picture of more than " + std::to_string(largest_map_side) + " pixels a side",
                              "ask for a lower resolution"));
  return static_cast<int>(pixels);
}

}  // namespace

Vec3d towards_eye(const MapView& view, Vec3d p) {
  if (view.projection == Projection::orthographic) return -1.0 * view.forward;
  const Vec3d back = view.eye - p;
  const double distance = length(back);
  return distance > 0 ? (1 / distance) * back : -1.0 * view.forward;
}

MapView orthographic_view(const Box3f& box, Vec3d forward, double pixel, int margin) {
  MapView view;
  view.pixel = pixel;
  aim(view, forward);
  Vec3d lo{1e300, 1e300, 1e300}, hi{-1e300, -1e300, -1e300};
  for (const Vec3d& c : corners_of(box)) {
    const Vec3d q{dot(c, view.right), dot(c, view.up), dot(c, view.forward)};
    lo = {std::min(lo.x, q.x), std::min(lo.y, q.y), std::min(lo.z, q.z)};
    hi = {std::max(hi.x, q.x), std::max(hi.y, q.y), std::max(hi.z, q.z)};
  }
  view.width = side_for((hi.x - lo.x) / pixel, margin);
  view.height = side_for((hi.y - lo.y) / pixel, margin);
  // A little before the box, so that depths are positive.
  view.eye = (0.5 * (lo.x + hi.x)) * view.right + (0.5 * (lo.y + hi.y)) * view.up + (lo.z - pixel) * view.forward;
  return view;
}

MapView perspective_view(const Box3f& box, Vec3d eye, double pixel, int margin) {
  MapView view;
  view.projection = Projection::perspective;
  view.eye = eye;
  const Vec3d centre = 0.5 * (to_double(box.lo) + to_double(box.hi));
  if (!is_finite(eye) || !(length(centre - eye) > 0)) throw InputError("view: the eye is at the centre of the box");
  aim(view, centre - eye);
  double reach = 0;
  for (const Vec3d& c : corners_of(box)) {
    const double depth = view.depth(c);
    if (!(depth > 1e-3))
      throw InputError(describe("view", "", "the eye is not in front of the whole box", "move it away from the model"));
    reach = std::max({reach, std::abs(dot(c - eye, view.right)) / depth, std::abs(dot(c - eye, view.up)) / depth});
  }
  view.pixel = pixel / length(centre - eye);
  view.width = view.height = side_for(2 * reach / view.pixel, margin);
  return view;
}

void check_view(const MapView& view, const std::string& name) {
  if (view.width < 1 || view.height < 1 || view.width > largest_map_side || view.height > largest_map_side)
    throw InputError(
        describe(name, "", "a picture of " + std::to_string(view.width) + "x" + std::to_string(view.height) + " pixels",
                 "give 1 to " + std::to_string(largest_map_side) + " a side"));
  if (!is_finite(view.eye) || !(view.pixel > 0) || !std::isfinite(view.pixel))
    throw InputError(describe(name, "", "the eye or the size of a pixel is not a finite number"));
  if (!(view.nearest >= 0) || !std::isfinite(view.nearest))
    throw InputError(describe(name, "", "the nearest depth is not a finite number, 0 or more"));
  const std::array<Vec3d, 3> axes{view.right, view.up, -1.0 * view.forward};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d expected = cross(axes[(i + 1) % 3], axes[(i + 2) % 3]);
    if (!(std::abs(dot(axes[i], axes[i]) - 1) < 1e-6) || !(length(axes[i] - expected) < 1e-6))
      throw InputError(describe(name, "", "right, up and forward are not an orthonormal, right-handed frame"));
  }
}

}  // namespace lodestone
