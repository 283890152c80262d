// Places of points in a picture, between which distances in pixels are measured.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "core/math/vec3.h"
#include "render/camera/camera.h"

namespace lodestone {

// x, y in pixels from the upper left corner of the picture; w: the depth along the view axis.
struct ScreenPoint {
  double x = 0, y = 0, w = 0;
  bool inside = false;  // the frustum
};

[[nodiscard]] inline double distance(const ScreenPoint& a, const ScreenPoint& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

// One camera's picture of a space: normalised space of the model that `view_projection` belongs to.
class Screen {
 public:
  Screen(const ViewProjection& view_projection, ImageSize size) : m_(view_projection), size_(size) {}

  // Empty for a point behind the near plane.
  [[nodiscard]] std::optional<ScreenPoint> project(Vec3d p) const {
    const std::array<double, 4> clip = to_clip(p);
    const auto [x, y, z, w] = clip;
    if (!(w > 0) || z < -w) return std::nullopt;
    return ScreenPoint{(1 + x / w) * 0.5 * size_.width, (1 - y / w) * 0.5 * size_.height, w,
                       std::abs(x) <= w && std::abs(y) <= w && z <= w};
  }

  // Clip coordinates of a point (last = 1) or a direction (last = 0).
  [[nodiscard]] std::array<double, 4> to_clip(Vec3d p, double last = 1) const {
    std::array<double, 4> clip{};
    for (std::size_t row = 0; row < 4; ++row)
      clip[row] = m_.m[4 * row] * p.x + m_.m[4 * row + 1] * p.y + m_.m[4 * row + 2] * p.z + last * m_.m[4 * row + 3];
    return clip;
  }

  [[nodiscard]] const ViewProjection& view_projection() const { return m_; }
  [[nodiscard]] ImageSize size() const { return size_; }

 private:
  ViewProjection m_;
  ImageSize size_;
};

}  // namespace lodestone
