// Identity of a set of triangles as a sum of 64-bit hashes, to compare the input of a hierarchy with its content.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "core/math/vec3.h"

namespace lodestone {

// Hash of a triangle by the bits of its corners: the same for its three rotations, another one if it is reversed. Signs
// of coordinates are ignored: the unit cube has none, and -0 is +0. Inline, since it runs for every input triangle.
[[nodiscard]] constexpr std::uint64_t triangle_fingerprint(Vec3f a, Vec3f b, Vec3f c) {
  // Both halves of a product of 128 bits. One half alone is linear in xy: points in a row gave hashes in a row.
  __extension__ using Product = unsigned __int128;
  const auto hash = [](Vec3f p) {
    const auto w = std::bit_cast<std::array<std::uint32_t, 3>>(p);
    const std::uint64_t xy = (w[0] | std::uint64_t{w[1]} << 32) & 0x7fff'ffff'7fff'ffffull;
    const std::uint64_t z = w[2] & 0x7fff'ffffu;
    const Product product = Product{xy + 0x9e37'79b9'7f4a'7c15ull} * (z + 0xd6e8'feb8'6659'fd93ull);
    return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
  };
  const std::uint64_t ha = hash(a), hb = hash(b), hc = hash(c);
  // Each directed edge on its own: the same for the rotations, not under reflection. What follows ties the edges of a
  // triangle to each other.
  const auto edge = [](std::uint64_t from, std::uint64_t to) { return from * std::rotl(to, 23); };
  const std::uint64_t sum = edge(ha, hb) + edge(hb, hc) + edge(hc, ha);
  const std::uint64_t mixed = (sum ^ (sum >> 32)) * 0x94d0'49bb'1331'11ebull;
  return mixed ^ (mixed >> 29);
}

}  // namespace lodestone
