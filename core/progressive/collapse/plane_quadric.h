// The quadric error of planes (garland1997), centred at a vertex so that 32-bit floats do.
#pragma once

#include <cmath>

#include "core/math/vec3.h"

namespace lodestone::progressive {

// Without initial values, so that fresh memory is touched by those who fill it: PlaneQuadric{} is zero.
// Sum of weight * distance^2 from planes, as a function of the shift d from the centre: d A d + 2 b d + c.
struct PlaneQuadric {
  float xx, xy, xz, yy, yz, zz;  // A
  float weight = 0;              // area that the planes stand for
  float c, bx, by, bz;

  [[nodiscard]] float at(Vec3f d) const {
    return d.x * (xx * d.x + 2 * (xy * d.y + xz * d.z + bx)) + d.y * (yy * d.y + 2 * (yz * d.z + by)) +
           d.z * (zz * d.z + 2 * bz) + c;
  }
  // A plane through the centre; n of unit length.
  void add_plane(Vec3f n, float w) {
    xx += w * n.x * n.x, xy += w * n.x * n.y, xz += w * n.x * n.z;
    yy += w * n.y * n.y, yz += w * n.y * n.z, zz += w * n.z * n.z;
  }
  // g g^T for the gradient g of an attribute.
  void add_gradient(Vec3f g, float w) { add_plane(g, w); }
  // Another one whose centre lies at `shift` from this one's.
  void add(const PlaneQuadric& o, Vec3f shift) {
    const Vec3f t{-shift.x, -shift.y, -shift.z};  // this centre as seen from the other one
    const float mx = o.xx * t.x + o.xy * t.y + o.xz * t.z, my = o.xy * t.x + o.yy * t.y + o.yz * t.z,
                mz = o.xz * t.x + o.yz * t.y + o.zz * t.z;
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    bx += o.bx + mx, by += o.by + my, bz += o.bz + mz;
    c += o.c + t.x * (mx + 2 * o.bx) + t.y * (my + 2 * o.by) + t.z * (mz + 2 * o.bz);
    weight += o.weight;
  }
};

}  // namespace lodestone::progressive
