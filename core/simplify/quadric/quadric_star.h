// One vertex and its ring in lanes: what set-up, collapse and relocation share.
#pragma once

#include <bit>

#include "core/simplify/quadric/quadric_kernel.h"

namespace lodestone::quadric {

template <class L>
template <int G>
inline auto BlockKernel<L>::load_star(Id v) const -> Star<G> {
  Star<G> star;
  const Point& p = a_.point[v];
  const Float x = Float::all(p.x), y = Float::all(p.y), z = Float::all(p.z);
  for (int g = 0; g < G; ++g) {
    const Points q = Points::gather(a_.point, a_.ring[v].lane + 8 * g);
    star.x[g] = q.x - x, star.y[g] = q.y - y, star.z[g] = q.z - z;
  }
  return star;
}

// The lanes behind the ring are undefined.
template <class L>
template <int G>
inline void BlockKernel<L>::next_in_ring(const Float (&a)[G], unsigned n, Float (&next)[G]) {
  if constexpr (G == 1) {
    next[0] = rotate(a[0], n);
  } else {
    next[0] = select(1u << 7, spread(a[1], 0), rotate(a[0], 8));
    next[1] = select(1u << (n - 9), spread(a[0], 0), rotate(a[1], 8));
  }
}

// Triangle k lies between neighbours k and k+1; of an open fan the last one does not exist.
template <class L>
template <int G>
inline auto BlockKernel<L>::faces_of(const Star<G>& star, unsigned n) const -> Faces<G> {
  Faces<G> f;
  Float nx[G], ny[G], nz[G];
  next_in_ring<G>(star.x, n, nx);
  next_in_ring<G>(star.y, n, ny);
  next_in_ring<G>(star.z, n, nz);
  for (int g = 0; g < G; ++g) {
    const Float &x = star.x[g], &y = star.y[g], &z = star.z[g];
    const Float ex = nx[g] - x, ey = ny[g] - y, ez = nz[g] - z;  // the edge that stays
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
template <class L>
template <int G>
inline unsigned BlockKernel<L>::flipped(const Faces<G>& f, Shift t) const {
  const Float x = Float::all(t.x), y = Float::all(t.y), z = Float::all(t.z);
  const Float share = Float::all(1 - least_height), zero = Float::all(0);
  unsigned bits = 0;
  for (int g = 0; g < G; ++g) {
    const Float loss = x * f.turn_x[g] + y * f.turn_y[g] + z * f.turn_z[g];
    const unsigned stays = less(loss, share * f.size[g]), flat = not_above(f.size[g], zero);
    bits |= (~(stays | flat) & 0xffu) << (8 * g);
  }
  return bits;
}

template <class L>
inline auto BlockKernel<L>::quadratic_form(const Body& q, const Float& x, const Float& y, const Float& z) -> Float {
  const Float two = Float::all(2);
  const Float xy = Float::all(q.xy), xz = Float::all(q.xz), yz = Float::all(q.yz);
  return x * (Float::all(q.xx) * x + two * (xy * y + xz * z + Float::all(q.bx))) +
         y * (Float::all(q.yy) * y + two * (yz * z + Float::all(q.by))) +
         z * (Float::all(q.zz) * z + two * Float::all(q.bz));
}

}  // namespace lodestone::quadric
