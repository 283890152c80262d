// A vertex and its neighbours in lanes, and the triangles between them.
#pragma once

#include "core/math/lanes/star_lanes.h"
#include "core/simplify/quadric/block.h"

namespace lodestone::quadric {
inline namespace LODESTONE_LANES {

// The triangles of a star. Moving the vertex by t keeps the normal of triangle k within 90 degrees iff
// t . turn_k < size_k, since the normal is linear in t.
template <int G>
struct Faces {
  Float8 nx[G], ny[G], nz[G];
  Float8 size[G];  // squared length of the normal
  Float8 turn_x[G], turn_y[G], turn_z[G];
};

template <int G>
[[nodiscard, gnu::always_inline]] inline Star<G> load_star(const Block& b, Id v) {
  return gather_star<G>(b.a.point, b.a.ring[v].lane, b.a.point[v]);
}

// Triangle k lies between neighbours k and k + 1; the last one of an open fan does not exist.
template <int G>
[[nodiscard, gnu::always_inline]] inline Faces<G> faces_of(const Star<G>& star, unsigned n) {
  Faces<G> f;
  const Star<G> next = next_around<G>(star, n);
  for (int g = 0; g < G; ++g) {
    const Float8 &x = star.x[g], &y = star.y[g], &z = star.z[g];
    const Float8 ex = next.x[g] - x, ey = next.y[g] - y, ez = next.z[g] - z;  // the edge that is kept
    f.nx[g] = y * ez - z * ey, f.ny[g] = z * ex - x * ez, f.nz[g] = x * ey - y * ex;
    f.size[g] = f.nx[g] * f.nx[g] + f.ny[g] * f.ny[g] + f.nz[g] * f.nz[g];
    f.turn_x[g] = ey * f.nz[g] - ez * f.ny[g];
    f.turn_y[g] = ez * f.nx[g] - ex * f.nz[g];
    f.turn_z[g] = ex * f.ny[g] - ey * f.nx[g];
  }
  return f;
}

// Triangles that have a normal and lose it, or see it turned by 90 degrees or more. Includes those that vanish, and
// lanes without a triangle: the caller masks both.
template <int G>
[[nodiscard, gnu::always_inline]] inline unsigned flipped(const Faces<G>& f, Vec3f t) {
  const Float8 x = all8(t.x), y = all8(t.y), z = all8(t.z), zero = all8(0);
  unsigned turned = 0;
  for (int g = 0; g < G; ++g) {
    const Float8 loss = x * f.turn_x[g] + y * f.turn_y[g] + z * f.turn_z[g];
    const unsigned kept = bits(loss < f.size[g]), flat = bits(f.size[g] <= zero);
    turned |= (~(kept | flat) & 0xffu) << (8 * g);
  }
  return turned;
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::quadric
