// The clipping plane that the user has chosen: across an axis of the scene, at a share of its extent.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/camera/camera.h"
#include "render/scene/scene_view.h"

namespace lodestone::viewer {

struct ClipChoice {
  bool on = false;
  int axis = 0;        // x, y, z
  float place = 0;     // from -1 to 1: from one end of the scene's sphere to the other
  bool other = false;  // the side of larger coordinates is cut off; true: the other one
  friend bool operator==(const ClipChoice&, const ClipChoice&) = default;
};

// Empty while it is off.
[[nodiscard]] inline std::optional<ClipPlane> plane_of(const ClipChoice& choice, const Sphere& scene) {
  if (!choice.on) return {};
  const double place = std::isfinite(choice.place) ? std::clamp(double{choice.place}, -1.0, 1.0) : 0;
  const double side = choice.other ? 1 : -1;
  const Vec3d normal{choice.axis == 0 ? side : 0, choice.axis == 1 ? side : 0, choice.axis == 2 ? side : 0};
  const Vec3d along{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  return ClipPlane{normal, dot(normal, scene.centre + place * scene.radius * along)};
}

}  // namespace lodestone::viewer
