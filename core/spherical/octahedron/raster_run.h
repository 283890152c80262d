// The body of the raster's inner loops, for one instruction set.
#pragma once

#include <array>
#include <cstdint>

#include "core/math/lanes/double4.h"
#include "core/spherical/octahedron/raster_kernel.h"

namespace lodestone::spherical {
inline namespace LODESTONE_LANES {

inline Double4 polynomial_a(Double4 u, Double4 v) {
  using namespace octahedral;
  return ((all4d(1) + (all4d(a_u) * u + all4d(a_v) * v)) + (all4d(a_uu) * u * u + all4d(a_vv) * v * v)) +
         all4d(a_uv) * (u * v);
}
inline Double4 polynomial_b(Double4 u, Double4 v) {
  using namespace octahedral;
  return ((all4d(b_0) + all4d(b_1) * (u + v)) + all4d(b_2) * (u * u + v * v)) + all4d(b_uv) * (u * v);
}

// direction_of() before it is made of unit length, operation by operation: planes do not ask for lengths.
inline Vec4x3 rays_of(Double4 s, Double4 t) {
  const Double4 one = all4d(1), x = all4d(2) * s - one, y = one - all4d(2) * t;
  const Double4 across = abs(x), up = abs(y);
  const Mask4 south = one < across + up;
  const Double4 u = select(south, one - up, across), v = select(south, one - across, up);
  const Vec4x3 q{u * polynomial_a(u, v), v * polynomial_a(v, u), (one - (u + v)) * polynomial_b(u, v)};
  return {copysign(q.x, x), copysign(q.y, y), select(south, all4d(-1), one) * q.z};
}

inline void set_rays(const SampleGrid& grid, SampleTile& tile) {
  constexpr std::uint32_t side = SampleTile::side;
  for (std::vector<double>& component : tile.ray) component.resize(std::size_t{side} * side);
  std::array<double, side> columns;
  for (std::uint32_t x = 0; x < side; ++x) columns[x] = grid.coordinate(tile.x + x);
  for (std::uint32_t y = 0; y < tile.height; ++y) {
    const Double4 row = all4d(grid.coordinate(tile.y + y));
    for (std::uint32_t x = 0; x < side; x += 4) {
      const Vec4x3 ray = rays_of(load4(&columns[x]), row);
      const std::size_t sample = std::size_t{y} * side + x;
      store(&tile.ray[0][sample], ray.x);
      store(&tile.ray[1][sample], ray.y);
      store(&tile.ray[2][sample], ray.z);
    }
  }
}

inline void cover(std::uint32_t triangle, const std::array<Vec3d, 3>& normals, const TileWindow& window,
                  SampleTile& tile) {
  const auto spread = [](Vec3d n) { return Vec4x3{all4d(n.x), all4d(n.y), all4d(n.z)}; };
  const Vec4x3 p = spread(normals[0]), q = spread(normals[1]), r = spread(normals[2]);
  const Double4 zero = all4d(0);
  const auto number = static_cast<std::int32_t>(triangle);
  const Int4 all{number, number, number, number};
  for (std::uint32_t y = window.top; y < window.bottom; ++y)
    for (std::uint32_t x = window.left & ~3u; x < window.right; x += 4) {
      const std::size_t sample = std::size_t{y} * SampleTile::side + x;
      const Vec4x3 d{load4(&tile.ray[0][sample]), load4(&tile.ray[1][sample]), load4(&tile.ray[2][sample])};
      const Double4 first = dot(p, d), second = dot(q, d), third = dot(r, d), sum = (first + second) + third;
      // Without area the sum is zero.
      const Mask4 beyond = (first < zero) | (second < zero) | (third < zero), whole = zero < sum;
      if ((~bits(beyond) & bits(whole)) == 0) continue;
      const Int4 before = load<Int4>(&tile.triangle[sample]);
      const Int4 taken = narrow(whole) & ~narrow(beyond) & (before == static_cast<std::int32_t>(no_triangle));
      store(&tile.triangle[sample], select(taken, all, before));
      const Double4 scale = all4d(1) / sum;
      const auto set = [&](std::size_t corner, Double4 share) {
        float* const to = &tile.weight[corner][sample];
        store(to, select(taken, narrow(share * scale), load<Float4>(to)));
      };
      set(0, first), set(1, second), set(2, third);
    }
}

inline constexpr RasterKernel raster_functions{&set_rays, &cover};

}  // namespace LODESTONE_LANES
}  // namespace lodestone::spherical
