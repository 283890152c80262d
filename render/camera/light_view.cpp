#include "render/camera/light_view.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace lodestone {
namespace {

Vec3d unit(Vec3d v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  const Vec3d scaled = (1 / largest) * v;  // no square over- or underflows
  return (1 / length(scaled)) * scaled;
}

// The axis farthest from a direction.
Vec3d axis_across(Vec3d d) {
  const Vec3d a{std::abs(d.x), std::abs(d.y), std::abs(d.z)};
  if (a.x <= a.y && a.x <= a.z) return {1, 0, 0};
  return a.y <= a.z ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
}

// The smallest 2^(k/4) that is not smaller. A size is kept until its contents have grown by a fifth.
double next_size(double least) {
  constexpr double steps = 4;
  double size = std::exp2(std::ceil(steps * std::log2(least)) / steps);
  if (size < least) size *= std::exp2(1 / steps);
  return size;
}

struct Extent {
  double lo = 0, hi = 0;
  [[nodiscard]] double half() const { return (hi - lo) / 2; }
};

// Extent of the points along an axis.
Extent extent_of(std::span<const Vec3d> points, Vec3d axis) {
  const auto along = [&](Vec3d p) { return dot(p, axis); };
  const auto [lo, hi] = std::ranges::minmax_element(points, {}, along);
  return {along(*lo), along(*hi)};
}

void check(Vec3d towards_light, std::span<const Vec3d> receivers, std::span<const Vec3d> casters) {
  const auto finite = [](Vec3d p) { return is_finite(p); };
  if (!is_finite(towards_light) || towards_light == Vec3d{})
    throw InputError(describe({}, "light", "its direction must be finite and not zero"));
  if (!std::ranges::all_of(receivers, finite) || !std::ranges::all_of(casters, finite))
    throw InputError(describe({}, "light", "the points that it falls on must be finite"));
}

}  // namespace

LightView fit_light(Vec3d towards_light, std::span<const Vec3d> receivers, std::span<const Vec3d> casters, int texels) {
  check(towards_light, receivers, casters);
  LightView view;
  view.towards_light = unit(towards_light);
  view.right = unit(cross(axis_across(view.towards_light), view.towards_light));
  view.up = cross(view.towards_light, view.right);
  if (receivers.empty()) return view;

  const Extent x = extent_of(receivers, view.right), y = extent_of(receivers, view.up);
  Extent z = extent_of(receivers, view.towards_light);
  const double z_size = std::max(z.hi - z.lo, 1e-30);
  if (!casters.empty()) {
    // Casters below all receivers throw no shadow on them.
    z.hi = std::max(z.hi, extent_of(casters, view.towards_light).hi);
  }
  const double least = std::max({x.half(), y.half(), z_size / 1024, 1e-12 * (std::abs(x.hi) + std::abs(y.hi))});
  // The margin, and half a texel that snapping moves the centre by.
  view.half = next_size(least / (1 - (2.0 * shadow_margin + 2) / texels));
  const double texel = 2 * view.half / texels;
  const auto snapped = [&](double v) { return std::round(v / texel) * texel; };
  view.centre_x = snapped((x.lo + x.hi) / 2);
  view.centre_y = snapped((y.lo + y.hi) / 2);
  // Depth in steps, too: the same surface gets the same depths while the scene stays much the same.
  const double step = std::max(view.half, next_size(std::max(z.hi - z.lo, 1e-30))) / 8;
  view.near = (std::floor(z.hi / step) + 1) * step + step / 2;
  view.far = (std::ceil(z.lo / step) - 1) * step - step / 2;
  return view;
}

ViewProjection light_projection(const LightView& view, const ModelPlacement& placement) {
  const auto column = [&](std::size_t k) { return Vec3d{placement[k], placement[4 + k], placement[8 + k]}; };
  ViewProjection vp;
  // Row r is scale (axis . p - centre); depth grows away from the light.
  const auto set_row = [&](std::size_t r, Vec3d axis, double scale, double centre) {
    for (std::size_t k = 0; k < 3; ++k) vp.m[4 * r + k] = static_cast<float>(scale * dot(axis, column(k)));
    vp.m[4 * r + 3] = static_cast<float>(scale * (dot(axis, column(3)) - centre));
  };
  set_row(0, view.right, 1 / view.half, view.centre_x);
  set_row(1, view.up, 1 / view.half, view.centre_y);
  set_row(2, view.towards_light, -2 / (view.near - view.far), (view.near + view.far) / 2);
  vp.m[15] = 1;
  return vp;
}

std::array<Vec3d, 8> corners_of(const Box3f& box, const ModelPlacement& placement) {
  std::array<Vec3d, 8> corners;
  for (std::size_t k = 0; k < 8; ++k) {
    const double x = k & 1 ? box.hi.x : box.lo.x, y = k & 2 ? box.hi.y : box.lo.y, z = k & 4 ? box.hi.z : box.lo.z;
    const auto row = [&](std::size_t r) {
      const double* m = &placement[4 * r];
      return m[0] * x + m[1] * y + m[2] * z + m[3];
    };
    corners[k] = {row(0), row(1), row(2)};
  }
  return corners;
}

}  // namespace lodestone
