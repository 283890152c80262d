// Exact signs of determinants: which way a triangle turns, in the plane and on the sphere.
#pragma once

#include "core/math/vec3.h"

namespace lodestone {

struct Vec2d {
  double x = 0, y = 0;
  friend constexpr bool operator==(const Vec2d&, const Vec2d&) = default;
};

// Both are exact for coordinates that are zero or of magnitude 2^-300 to 2^300. A determinant in doubles decides where
// its error bound allows; otherwise the sum is computed exactly, as an expansion (shewchuk1997).

// The sign of det(a, b, c): 1 if c is on the left of the way from a to b, seen from outside of a sphere around the
// origin.
[[nodiscard]] int orientation(Vec3d a, Vec3d b, Vec3d c);

// 1 if the triangle is counter-clockwise, 0 if its corners are on a line.
[[nodiscard]] int orientation(Vec2d a, Vec2d b, Vec2d c);

// A point near the unit sphere with coordinates on a lattice of 2^-53: none is too small for exact arithmetic.
[[nodiscard]] constexpr Vec3d snapped(Vec3d p) {
  constexpr double shift = 1.5;
  return {(p.x + shift) - shift, (p.y + shift) - shift, (p.z + shift) - shift};
}

}  // namespace lodestone
