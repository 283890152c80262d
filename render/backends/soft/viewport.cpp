#include "render/backends/soft/viewport.h"

#include <algorithm>
#include <cmath>

namespace lodestone::soft {

ClipVertex to_clip(const ViewProjection& vp, Vec3f p) {
  const auto& m = vp.m;
  return {((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3], ((m[4] * p.x + m[5] * p.y) + m[6] * p.z) + m[7],
          ((m[8] * p.x + m[9] * p.y) + m[10] * p.z) + m[11], ((m[12] * p.x + m[13] * p.y) + m[14] * p.z) + m[15]};
}

Viewport::Viewport(ImageSize size)
    : half_width_(static_cast<float>(size.width) * (subpixels / 2)),
      half_height_(static_cast<float>(size.height) * (subpixels / 2)),
      guard_x_(1 + 2 * guard_pixels / static_cast<float>(size.width)),
      guard_y_(1 + 2 * guard_pixels / static_cast<float>(size.height)) {}

std::uint32_t Viewport::outcode(const ClipVertex& v) const {
  return (v.x < -v.w ? Outside::left : 0u) | (v.x > v.w ? Outside::right : 0u) | (v.y < -v.w ? Outside::bottom : 0u) |
         (v.y > v.w ? Outside::top : 0u) | (v.z < -v.w ? Outside::near : 0u) | (v.z > v.w ? Outside::far : 0u);
}

bool Viewport::needs_clipping(const ClipVertex& v) const {
  return !(v.z >= -v.w && v.z <= v.w && std::abs(v.x) <= guard_x_ * v.w && std::abs(v.y) <= guard_y_ * v.w && v.w > 0);
}

WindowVertex Viewport::snap(const ClipVertex& v) const {
  WindowVertex out;
  out.inverse_w = 1 / v.w;
  out.x = static_cast<std::int32_t>(std::nearbyint((1 + v.x * out.inverse_w) * half_width_));
  out.y = static_cast<std::int32_t>(std::nearbyint((1 - v.y * out.inverse_w) * half_height_));
  out.z = std::max(0.5f + 0.5f * (v.z * out.inverse_w), 0.0f);
  return out;
}

}  // namespace lodestone::soft
