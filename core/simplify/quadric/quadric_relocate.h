// The survivors' last step.
#pragma once

#include "core/simplify/quadric/quadric_kernel.h"

namespace lodestone::quadric {

// Half-edge collapses leave survivors on input vertices. Moving each once, at the end, to the minimum of its quadric
// takes a sixth off the error; inside the loop it would gain no more and cost three times as much.
template <class L>
void BlockKernel<L>::relocate_survivors() {
  // Listed first: whether a vertex has survived is nothing a processor could guess. The queue is done with its links.
  Id* const survivors = a_.next_in_bucket;
  unsigned count = 0;
  for (unsigned v = 0; v < count_; ++v) {
    survivors[count] = static_cast<Id>(v);
    // Collapsed vertices have lost their movable flag; those on borders and seams, or where surfaces meet, stay there
    // by staying where they are.
    count += (a_.ring[v].lane[flags_lane] & (movable | open | seamed | pile)) == movable;
  }
  for (unsigned i = 0; i < count; ++i) {
    const Id v = survivors[i];
    const unsigned n = degree(v);
    if (n <= 8) {
      relocate<1>(v, n);
    } else {
      relocate<2>(v, n);
    }
  }
}

// Minimum of the quadric relative to the vertex, by the adjugate of A; A is positive definite by its stiffness.
template <class L>
auto BlockKernel<L>::minimum_of(const Body& q) -> Shift {
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
template <class L>
auto BlockKernel<L>::to_lattice(Id v, Shift t) const -> Shift {
  if (!input_.lattice) return t;
  const Point& p = a_.point[v];
  const double inverse = 1 / double{scale_};
  const Vec3f at =
      input_.lattice.nearest(Vec3d{(double{p.x} + double{t.x}) * inverse, (double{p.y} + double{t.y}) * inverse,
                                   (double{p.z} + double{t.z}) * inverse});
  return {at.x * scale_ - p.x, at.y * scale_ - p.y, at.z * scale_ - p.z};
}

template <class L>
template <int G>
void BlockKernel<L>::relocate(Id v, unsigned n) {
  const Shift t = to_lattice(v, minimum_of(a_.body[v]));
  const Star<G> star = load_star<G>(v);
  const unsigned lanes = (1u << n) - 1;
  // At most as far as the longest edge: beyond that the minimum says nothing about this star.
  const float squared = t.x * t.x + t.y * t.y + t.z * t.z;
  unsigned longer = 0;
  for (int g = 0; g < G; ++g) {
    const Float edge = star.x[g] * star.x[g] + star.y[g] * star.y[g] + star.z[g] * star.z[g];
    longer |= not_above(Float::all(squared), edge) << (8 * g);
  }
  if ((longer & lanes) == 0 || (flipped<G>(faces_of<G>(star, n), t) & lanes) != 0) return;
  Point& p = a_.point[v];
  const Point moved{p.x + t.x, p.y + t.y, p.z + t.z, 0};
  const Vec3f answer{moved.x / scale_, moved.y / scale_, moved.z / scale_};
  const float x = moved.x - p.x, y = moved.y - p.y, z = moved.z - p.z;
  const float room = bound_ - a_.body[v].reach;
  const bool near = room > 0 && x * x + y * y + z * z <= room * room;
  if (!near && !members_reach(v, answer)) return;
  p = moved;
  result_.positions[v] = answer;
}

// In double and on the caller's coordinates: the bound itself, not a safe side of it.
template <class L>
bool BlockKernel<L>::members_reach(Id v, const Vec3f& position) const {
  const double bound = input_.max_displacement;
  for (Id m = v; m != none; m = a_.member[m].next) {
    const Vec3f& from = input_.positions[m];
    const double x = double{position.x} - double{from.x}, y = double{position.y} - double{from.y},
                 z = double{position.z} - double{from.z};
    if (!(x * x + y * y + z * z <= bound * bound * (1 - 1e-12))) return false;
  }
  return true;
}

}  // namespace lodestone::quadric
