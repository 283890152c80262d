#include "core/hierarchy/hierarchy.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

std::int16_t to_snorm16(float v) {
  return static_cast<std::int16_t>(std::lround(std::clamp(v, -1.0f, 1.0f) * 32767.0f));
}

float from_snorm16(std::int16_t v) { return std::max(static_cast<float>(v) / 32767.0f, -1.0f); }

float sign_not_zero(float v) { return v < 0 ? -1.0f : 1.0f; }

}  // namespace

PackedNormal pack_normal(Vec3f n) {
  const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (!(sum > 0) || !std::isfinite(sum)) return {0, 0};
  float u = n.x / sum, v = n.y / sum;
  if (n.z < 0) {
    const float folded = (1 - std::abs(v)) * sign_not_zero(u);
    v = (1 - std::abs(u)) * sign_not_zero(v);
    u = folded;
  }
  return {to_snorm16(u), to_snorm16(v)};
}

Vec3f unpack_normal(PackedNormal packed) {
  Vec3f n{from_snorm16(packed.u), from_snorm16(packed.v), 0};
  n.z = 1 - std::abs(n.x) - std::abs(n.y);
  if (n.z < 0) {
    const float folded = (1 - std::abs(n.y)) * sign_not_zero(n.x);
    n.y = (1 - std::abs(n.x)) * sign_not_zero(n.y);
    n.x = folded;
  }
  return (1 / length(n)) * n;
}

int Hierarchy::level_of(std::uint32_t cell) const {
  const auto after = std::upper_bound(levels.begin(), levels.end(), cell,
                                      [](std::uint32_t c, const Level& l) { return c < l.first_cell; });
  return static_cast<int>(after - levels.begin()) - 1;
}

}  // namespace lodestone
