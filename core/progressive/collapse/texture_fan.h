// The triangles around a vertex on the texture, in lanes: which of them a point is in, and which edges cross.
#pragma once

#include <cstdint>

#include "core/math/lanes/double4.h"

namespace lodestone::progressive {

// A vector on the texture.
struct Way {
  double u = 0, v = 0;
  friend Way operator-(Way a, Way b) { return {a.u - b.u, a.v - b.v}; }
};
[[nodiscard]] inline double cross(Way a, Way b) { return a.u * b.v - a.v * b.u; }

// Vectors by coordinate, with room for whole groups of lanes.
template <std::uint32_t N>
struct Ways {
  alignas(32) double u[N + 4], v[N + 4];
  [[nodiscard]] Way operator[](std::uint32_t k) const { return {u[k], v[k]}; }
  void set(std::uint32_t k, Way w) { u[k] = w.u, v[k] = w.v; }
};

struct TextureFan {
  static constexpr std::uint32_t max_spokes = 64;

  std::uint32_t spokes = 0, sectors = 0;
  Ways<max_spokes> spoke, out;                   // texture coordinates of the neighbours; from the vertex to them
  Ways<max_spokes> first, second;                // by sector: texture coordinates of its two neighbours
  alignas(32) double of_vertex[max_spokes + 4];  // by sector: twice its area

  // Makes the lanes after the last spoke and sector such that nothing is found there.
  void finish() {
    for (std::uint32_t k = 0; k < 4; ++k) {
      out.set(spokes + k, {});
      first.set(sectors + k, {}), second.set(sectors + k, {});
      of_vertex[sectors + k] = 0;
    }
  }
};

// The places of the vertex and of the neighbour that it is to collapse into.
struct TextureStep {
  Way to, back;  // of the neighbour; from there to the vertex
};

inline namespace LODESTONE_LANES {

// The sectors that, with the neighbour in place of the vertex, have the vertex inside or within rounding of it.
inline std::uint64_t sectors_near(const TextureFan& fan, const TextureStep& step) {
  const Double4 to_u = all4d(step.to.u), to_v = all4d(step.to.v), back_u = all4d(step.back.u),
                back_v = all4d(step.back.v), zero = all4d(0), one = all4d(1), least = all4d(-2e-6);
  std::uint64_t found = 0;
  for (std::uint32_t k = 0; k < fan.sectors; k += 4) {
    const Double4 au = load4(fan.first.u + k) - to_u, av = load4(fan.first.v + k) - to_v;
    const Double4 bu = load4(fan.second.u + k) - to_u, bv = load4(fan.second.v + k) - to_v;
    const Double4 area = au * bv - av * bu, size = abs(area), sign = copysign(one, area);
    const Double4 of_vertex = sign * load4(fan.of_vertex + k), of_first = sign * (back_u * bv - back_v * bu);
    const unsigned outside = bits(of_vertex < least * size) | bits(of_first < least * size);
    found |= std::uint64_t{bits(zero < size) & ~outside} << k;
  }
  return found;
}

// For each new edge, from the neighbour to spoke k, the old edges, from the vertex to the spokes, that it crosses;
// those with an end in common do not count.
inline void find_crossings(const TextureFan& fan, const TextureStep& step, std::uint64_t* crossed) {
  const Double4 back_u = all4d(step.back.u), back_v = all4d(step.back.v), zero = all4d(0), one = all4d(1);
  for (std::uint32_t k = 0; k < fan.spokes; ++k) {
    const Way edge = fan.spoke[k] - step.to;
    const Double4 edge_u = all4d(edge.u), edge_v = all4d(edge.v), at_new = all4d(cross(step.back, edge));
    std::uint64_t found = 0;
    for (std::uint32_t m = 0; m < fan.spokes; m += 4) {
      const Double4 out_u = load4(fan.out.u + m), out_v = load4(fan.out.v + m);
      const Double4 det = edge_u * out_v - edge_v * out_u, size = abs(det), sign = copysign(one, det);
      const Double4 s = sign * (back_u * out_v - back_v * out_u), t = sign * at_new;
      const unsigned beyond = bits(s < zero) | bits(size < s) | bits(t < zero) | bits(size < t);
      found |= std::uint64_t{bits(zero < size) & ~beyond} << m;
    }
    crossed[k] = found & ~(std::uint64_t{1} << k);
  }
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::progressive
