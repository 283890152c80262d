#include "core/hierarchy/hierarchy.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lodestone {
namespace {

std::int16_t to_snorm16(float v) {
  return static_cast<std::int16_t>(std::lround(std::clamp(v, -1.0f, 1.0f) * 32767.0f));
}

float from_snorm16(std::int16_t v) { return std::max(static_cast<float>(v) / 32767.0f, -1.0f); }

float sign_not_zero(float v) { return v < 0 ? -1.0f : 1.0f; }

// splitmix64's finalizer (Steele et al. 2014): every input bit reaches every output bit.
constexpr std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58'476d'1ce4'e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d0'49bb'1331'11ebull;
  return z ^ (z >> 31);
}

// Multiplicative: three rounds a triangle end in one full mix, and this runs once for every input triangle.
std::uint64_t hash_position(Vec3f p) {
  const auto bits = [](float v) { return std::uint64_t{std::bit_cast<std::uint32_t>(v + 0.0f)}; };
  const std::uint64_t xy = (bits(p.x) | (bits(p.y) << 32)) * 0x9e37'79b9'7f4a'7c15ull;
  return (xy ^ (xy >> 32)) + bits(p.z) * 0xd6e8'feb8'6659'fd93ull;
}

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

std::uint64_t triangle_fingerprint(Vec3f a, Vec3f b, Vec3f c) {
  const std::uint64_t ha = hash_position(a), hb = hash_position(b), hc = hash_position(c);
  // Symmetric under rotation, not under reflection: each directed edge is hashed on its own.
  const auto edge = [](std::uint64_t from, std::uint64_t to) {
    const std::uint64_t h = (from ^ std::rotl(to, 23)) * 0xa076'1d64'78bd'642full;
    return h ^ (h >> 32);
  };
  return mix(edge(ha, hb) + edge(hb, hc) + edge(hc, ha));
}

}  // namespace lodestone
