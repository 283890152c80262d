// The exact orientation of three vectors, which tells whether a triangle on the sphere is turned over.
#pragma once

#include "core/math/vec3.h"

namespace lodestone::spherical {

// The sign of det(a, b, c): 1 if c is on the left of the way from a to b, seen from outside. A determinant in doubles
// decides where its error bound allows; otherwise the sum is computed exactly, as an expansion (shewchuk1997). Exact
// for coordinates that are zero or of magnitude 2^-300 to 2^300, and so for those of snapped().
[[nodiscard]] int orientation(Vec3d a, Vec3d b, Vec3d c);

// A point near the unit sphere with coordinates on a lattice of 2^-53: none is too small for exact arithmetic.
[[nodiscard]] constexpr Vec3d snapped(Vec3d p) {
  constexpr double shift = 1.5;
  return {(p.x + shift) - shift, (p.y + shift) - shift, (p.z + shift) - shift};
}

}  // namespace lodestone::spherical
