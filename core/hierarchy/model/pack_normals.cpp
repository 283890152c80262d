#include "core/hierarchy/model/pack_normals.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone {
namespace {

// Halves away from zero; |v| <= 1.
std::int16_t to_snorm16(float v) { return static_cast<std::int16_t>(v * 32767.0f + std::copysign(0.5f, v)); }

Int4 to_snorm16(Float4 v) { return __builtin_convertvector(v * 32767.0f + copysign(all4(0.5f), v), Int4); }

float from_snorm16(std::int16_t v) { return std::max(static_cast<float>(v) / 32767.0f, -1.0f); }

float sign_not_zero(float v) { return v < 0 ? -1.0f : 1.0f; }

}  // namespace

PackedNormal pack_normal(Vec3f n) {
  const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (!(sum > 0) || !std::isfinite(sum)) return {0, 0};
  float u = n.x / sum, v = n.y / sum;
  if (n.z < 0) {
    const float folded = std::copysign(1 - std::abs(v), u);
    v = std::copysign(1 - std::abs(u), v);
    u = folded;
  }
  return {to_snorm16(u), to_snorm16(v)};
}

// Lane by lane what pack_normal does, on four normals at a time.
void pack_normals(std::span<const Float4> n, std::span<PackedNormal> packed) {
  for (std::size_t i = 0; i < n.size(); i += 4) {
    const std::size_t last = n.size() - 1;
    const auto [x, y, z, unused] =
        transposed(n[i], n[std::min(i + 1, last)], n[std::min(i + 2, last)], n[std::min(i + 3, last)]);
    const Float4 sum = abs(x) + abs(y) + abs(z);
    const Int4 valid = (sum > 0.0f) & (sum <= std::numeric_limits<float>::max()), below = z < 0.0f;
    const Float4 u = x / sum, v = y / sum;
    const Float4 folded_u = below ? copysign(1.0f - abs(v), u) : u, folded_v = below ? copysign(1.0f - abs(u), v) : v;
    const Int4 u16 = to_snorm16(valid ? folded_u : Float4{}), v16 = to_snorm16(valid ? folded_v : Float4{});
    for (std::size_t k = 0; k < std::min<std::size_t>(4, n.size() - i); ++k)
      packed[i + k] = {static_cast<std::int16_t>(u16[k]), static_cast<std::int16_t>(v16[k])};
  }
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

}  // namespace lodestone
