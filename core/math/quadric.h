// Quadric error metrics (garland1997): sums of weighted squared distances from planes.
//
// `Quadric` is kept in double about any origin. `CentredQuadric` is kept in single precision about a vertex: with the
// origin there, sums lose nothing to cancellation, and a fresh quadric has neither a linear term nor an error.
#pragma once

#include "core/math/vec3.h"

namespace lodestone {

// x'Ax + 2b'x + c with A symmetric, and the sum of the weights of its planes (an area). Divided by that weight it is a
// mean squared distance, which makes the costs of large and small stars comparable.
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

  // The plane through `point` with the unit normal `n`.
  void add_plane(Vec3d n, Vec3d point, double w) {
    const double d = -dot(n, point);
    xx += w * n.x * n.x, xy += w * n.x * n.y, xz += w * n.x * n.z;
    yy += w * n.y * n.y, yz += w * n.y * n.z, zz += w * n.z * n.z;
    b = b + (w * d) * n;
    c += w * d * d;
    weight += w;
  }

  // The mean squared distance of x; 0 without planes. Rounding may leave a tiny negative value, which is clamped.
  [[nodiscard]] double cost(Vec3d x) const {
    if (!(weight > 0)) return 0;
    const double sum = dot(x, times(x)) + 2 * dot(b, x) + c;
    return sum > 0 ? sum / weight : 0;
  }

  // The minimum of the mean squared distance + stiffness |x - p|^2; p itself if that has no solution. `stiffness` is
  // relative to the trace of A over the weight, which is 1; it keeps flat and cylindrical stars in place.
  [[nodiscard]] Vec3d minimum_near(Vec3d p, double stiffness) const {
    if (!(weight > 0)) return p;
    const double s = stiffness * weight;
    const double a = xx + s, d = yy + s, f = zz + s;
    const Vec3d gradient = times(p) + b;  // then one Newton step by the adjugate
    const double c00 = d * f - yz * yz, c01 = xz * yz - xy * f, c02 = xy * yz - xz * d;
    const double c11 = a * f - xz * xz, c12 = xy * xz - a * yz, c22 = a * d - xy * xy;
    const double determinant = a * c00 + xy * c01 + xz * c02;
    if (!(determinant > 0)) return p;
    const Vec3d step{dot({c00, c01, c02}, gradient), dot({c01, c11, c12}, gradient), dot({c02, c12, c22}, gradient)};
    const Vec3d x = p - (1 / determinant) * step;
    return is_finite(x) ? x : p;
  }

 private:
  [[nodiscard]] Vec3d times(Vec3d x) const {
    return {xx * x.x + xy * x.y + xz * x.z, xy * x.x + yy * x.y + yz * x.z, xz * x.x + yz * x.y + zz * x.z};
  }
};

// d'Ad + 2b'd + c for the shift d from the centre. Without initial values, so that fresh memory is touched by the code
// that fills it: CentredQuadric{} is zero.
struct CentredQuadric {
  float xx, xy, xz, yy, yz, zz;
  float weight;  // the area that the planes stand for
  float c;       // the value at the centre
  float bx, by, bz;

  [[nodiscard]] float at(Vec3f d) const {
    return d.x * (xx * d.x + 2 * (xy * d.y + xz * d.z + bx)) + d.y * (yy * d.y + 2 * (yz * d.z + by)) +
           d.z * (zz * d.z + 2 * bz) + c;
  }
  // A plane through the centre with the unit normal n; or g g' for the gradient g of an attribute.
  void add_plane(Vec3f n, float w) {
    xx += w * n.x * n.x, xy += w * n.x * n.y, xz += w * n.x * n.z;
    yy += w * n.y * n.y, yz += w * n.y * n.z, zz += w * n.z * n.z;
  }
  // Another quadric, whose centre is `shift` away from this one's.
  void add(const CentredQuadric& o, Vec3f shift) {
    const Vec3f t{-shift.x, -shift.y, -shift.z};  // this centre as seen from the other one
    const float mx = o.xx * t.x + o.xy * t.y + o.xz * t.z, my = o.xy * t.x + o.yy * t.y + o.yz * t.z,
                mz = o.xz * t.x + o.yz * t.y + o.zz * t.z;
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    bx += o.bx + mx, by += o.by + my, bz += o.bz + mz;
    c += o.c + t.x * (mx + 2 * o.bx) + t.y * (my + 2 * o.by) + t.z * (mz + 2 * o.bz);
    weight += o.weight;
  }
};

}  // namespace lodestone
