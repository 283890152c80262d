// The neighbours of a vertex in lanes, relative to it, in G groups of eight; and quadrics evaluated at all of them.
#pragma once

#include "core/math/lanes/float8.h"
#include "core/math/quadric.h"

namespace lodestone {
inline namespace LODESTONE_LANES {

template <int G>
struct Star {
  Float8 x[G], y[G], z[G];
};

template <int G, class Id>
[[nodiscard, gnu::always_inline]] inline Star<G> gather_star(const AlignedPoint* points, const Id* ids,
                                                             const AlignedPoint& centre) {
  Star<G> star;
  const Float8 x = all8(centre.x), y = all8(centre.y), z = all8(centre.z);
  for (int g = 0; g < G; ++g) {
    const Points8 q = gather(points, ids + 8 * g);
    star.x[g] = q.x - x, star.y[g] = q.y - y, star.z[g] = q.z - z;
  }
  return star;
}

// In each lane the next neighbour around a ring of n; the lanes after the ring are undefined.
template <int G>
[[nodiscard, gnu::always_inline]] inline Star<G> next_around(const Star<G>& star, unsigned n) {
  if constexpr (G == 1) {
    return {{rotate(star.x[0], n)}, {rotate(star.y[0], n)}, {rotate(star.z[0], n)}};
  } else {
    const auto first = [](const Float8(&a)[G]) { return select(1u << 7, spread(a[1], 0), rotate(a[0], 8)); };
    const auto second = [n](const Float8(&a)[G]) { return select(1u << (n - 9), spread(a[0], 0), rotate(a[1], 8)); };
    return {{first(star.x), second(star.x)}, {first(star.y), second(star.y)}, {first(star.z), second(star.z)}};
  }
}

// The value of a quadric at a shift, less the constant: the operations of CentredQuadric::at, in its order.
[[nodiscard, gnu::always_inline]] inline Float8 quadratic_form(const CentredQuadric& q, const Float8& x,
                                                               const Float8& y, const Float8& z) {
  const Float8 two = all8(2);
  const Float8 xy = all8(q.xy), xz = all8(q.xz), yz = all8(q.yz);
  return x * (all8(q.xx) * x + two * (xy * y + xz * z + all8(q.bx))) +
         y * (all8(q.yy) * y + two * (yz * z + all8(q.by))) + z * (all8(q.zz) * z + two * all8(q.bz));
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone
