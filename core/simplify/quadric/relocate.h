// The last step of the survivors: to the minimum of their quadrics.
#pragma once

#include "core/simplify/quadric/star.h"

namespace lodestone::quadric {
inline namespace LODESTONE_LANES {

// The minimum of the quadric relative to the vertex, by the adjugate of A; A is positive definite by its stiffness.
inline Vec3f minimum_of(const Body& q) {
  const double xx = q.xx, xy = q.xy, xz = q.xz, yy = q.yy, yz = q.yz, zz = q.zz;
  const double c00 = yy * zz - yz * yz, c01 = xz * yz - xy * zz, c02 = xy * yz - xz * yy;
  const double c11 = xx * zz - xz * xz, c12 = xy * xz - xx * yz, c22 = xx * yy - xy * xy;
  const double determinant = xx * c00 + xy * c01 + xz * c02;
  if (!(determinant > 0)) return {0, 0, 0};
  const double s = -1 / determinant, bx = q.bx, by = q.by, bz = q.bz;
  return {static_cast<float>(s * (c00 * bx + c01 * by + c02 * bz)),
          static_cast<float>(s * (c01 * bx + c11 * by + c12 * bz)),
          static_cast<float>(s * (c02 * bx + c12 * by + c22 * bz))};
}

// The shift to the lattice point nearest to where t leads, before any test of it. Exact: both ends are multiples of the
// step, which a float holds.
inline Vec3f to_lattice(const Block& b, Id v, Vec3f t) {
  if (!b.input.lattice) return t;
  const AlignedPoint& p = b.a.point[v];
  const double inverse = 1 / double{b.scale};
  const Vec3f at =
      b.input.lattice.nearest(Vec3d{(double{p.x} + double{t.x}) * inverse, (double{p.y} + double{t.y}) * inverse,
                                    (double{p.z} + double{t.z}) * inverse});
  return {at.x * b.scale - p.x, at.y * b.scale - p.y, at.z * b.scale - p.z};
}

// In double and on the caller's coordinates: the bound itself, not a safe side of it.
inline bool members_reach(const Block& b, Id v, const Vec3f& position) {
  const double bound = b.input.max_displacement;
  for (Id m = v; m != none; m = b.a.member[m].next) {
    const Vec3f& from = b.input.positions[m];
    const double x = double{position.x} - double{from.x}, y = double{position.y} - double{from.y},
                 z = double{position.z} - double{from.z};
    if (!(x * x + y * y + z * z <= bound * bound * (1 - 1e-12))) return false;
  }
  return true;
}

template <int G>
inline void relocate(Block& b, Id v, unsigned n) {
  const Vec3f t = to_lattice(b, v, minimum_of(b.a.body[v]));
  const Star<G> star = load_star<G>(b, v);
  const unsigned lanes = (1u << n) - 1;
  // At most as far as the longest edge: beyond that the minimum says nothing about this star.
  const float squared = t.x * t.x + t.y * t.y + t.z * t.z;
  unsigned longer = 0;
  for (int g = 0; g < G; ++g) {
    const Float8 edge = star.x[g] * star.x[g] + star.y[g] * star.y[g] + star.z[g] * star.z[g];
    longer |= bits(all8(squared) <= edge) << (8 * g);
  }
  if ((longer & lanes) == 0 || (flipped<G>(faces_of<G>(star, n), t) & lanes) != 0) return;
  AlignedPoint& p = b.a.point[v];
  const AlignedPoint moved{p.x + t.x, p.y + t.y, p.z + t.z, 0};
  const Vec3f position{moved.x / b.scale, moved.y / b.scale, moved.z / b.scale}, way = moved - p;
  const float room = b.bound - b.a.body[v].reach;
  const bool near = room > 0 && way.x * way.x + way.y * way.y + way.z * way.z <= room * room;
  if (!near && !members_reach(b, v, position)) return;
  p = moved;
  b.result.positions[v] = position;
}

// Half-edge collapses leave survivors on input vertices. Moving each once, at the end, to the minimum of its quadric
// takes a sixth off the error; inside the loop it would gain no more and cost three times as much.
inline void relocate_survivors(Block& b) {
  // Listed first, since no processor can guess which vertices survive. The queue no longer needs its links.
  Id* const survivors = b.a.next_in_bucket;
  unsigned count = 0;
  for (unsigned v = 0; v < b.count; ++v) {
    survivors[count] = static_cast<Id>(v);
    // Collapsed vertices have lost their movable flag. Vertices on borders and seams, and where surfaces meet, are kept
    // in place, so that they remain there.
    count += (b.a.ring[v].lane[flags_lane] & (movable | open | seamed | nonmanifold)) == movable;
  }
  for (unsigned i = 0; i < count; ++i) {
    const Id v = survivors[i];
    const unsigned n = b.degree(v);
    if (n <= 8) {
      relocate<1>(b, v, n);
    } else {
      relocate<2>(b, v, n);
    }
  }
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::quadric
