// Quadric error metric (garland1997), in double: the sum of weighted squared distances to planes.
//
// Divided by the total weight it is a mean squared distance, which makes the costs of big and small stars comparable.
#pragma once

#include "core/math/vec3.h"

namespace lodestone {

// x'Ax + 2b'x + c with A symmetric, and the sum of the weights of its planes (an area).
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3d b;
  double c = 0;
  double weight = 0;

  Quadric& operator+=(const Quadric& q) {
    xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
    b = b + q.b;
    c += q.c;
    weight += q.weight;
    return *this;
  }

  // Plane through `point` with the unit normal `n`.
  void add_plane(Vec3d n, Vec3d point, double w) {
    const double d = -dot(n, point);
    xx += w * n.x * n.x, xy += w * n.x * n.y, xz += w * n.x * n.z;
    yy += w * n.y * n.y, yz += w * n.y * n.z, zz += w * n.z * n.z;
    b = b + (w * d) * n;
    c += w * d * d;
    weight += w;
  }

  // Mean squared distance of x; 0 without planes. Rounding may leave a tiny negative value, which is clamped.
  [[nodiscard]] double cost(Vec3d x) const {
    if (!(weight > 0)) return 0;
    const Vec3d ax{xx * x.x + xy * x.y + xz * x.z, xy * x.x + yy * x.y + yz * x.z, xz * x.x + yz * x.y + zz * x.z};
    const double sum = dot(x, ax) + 2 * dot(b, x) + c;
    return sum > 0 ? sum / weight : 0;
  }

  // Minimum of the mean squared distance + stiffness |x - p|^2; p itself where that has no solution. `stiffness` is
  // relative to the trace of A over the weight, which is 1; it keeps flat and cylindrical stars where they are.
  [[nodiscard]] Vec3d minimum_near(Vec3d p, double stiffness) const;
};

inline Vec3d Quadric::minimum_near(Vec3d p, double stiffness) const {
  if (!(weight > 0)) return p;
  const double s = stiffness * weight;
  const double a = xx + s, d = yy + s, f = zz + s;
  // Gradient at p, then one Newton step by the adjugate.
  const Vec3d g{xx * p.x + xy * p.y + xz * p.z + b.x, xy * p.x + yy * p.y + yz * p.z + b.y,
                xz * p.x + yz * p.y + zz * p.z + b.z};
  const double c00 = d * f - yz * yz, c01 = xz * yz - xy * f, c02 = xy * yz - xz * d;
  const double c11 = a * f - xz * xz, c12 = xy * xz - a * yz, c22 = a * d - xy * xy;
  const double determinant = a * c00 + xy * c01 + xz * c02;
  if (!(determinant > 0)) return p;
  const Vec3d step{c00 * g.x + c01 * g.y + c02 * g.z, c01 * g.x + c11 * g.y + c12 * g.z,
                   c02 * g.x + c12 * g.y + c22 * g.z};
  const Vec3d x = p - (1 / determinant) * step;
  return is_finite(x) ? x : p;
}

}  // namespace lodestone
