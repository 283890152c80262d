// The map between the unit square and the unit sphere by way of a flat octahedron, with little stretch.
//
// The square is an octahedron cut open along four of its edges (praun2003): the north pole (0, 0, 1) is at its centre,
// the equator is the diamond through the middles of its sides, the south pole is at all four corners. Each side is one
// of four arcs from the south pole to the equator, twice: point a of a side is the same direction as point 1 - a.
// Within an octant the map is a polynomial of degree 2 on each coordinate, then normalised, with coefficients that
// minimize the L2 stretch of both directions. Efficiency (sander2001): 0.891 from square to sphere, 0.853 back.
//
// Signs and exchange of x and y commute with the map bit for bit; directions on the cut arcs (x or y zero, z negative)
// come out exactly on the sides of the square, and sides exactly on the arcs.
#pragma once

#include <array>
#include <cmath>

#include "core/math/vec3.h"

namespace lodestone::spherical {

// A point of the square, (0, 0) to (1, 1). The sphere's x grows with s, and its y falls with t: an image whose rows run
// down shows the surface as it is seen from outside, writing not mirrored.
struct SquarePoint {
  double s = 0, t = 0;
  friend constexpr bool operator==(const SquarePoint&, const SquarePoint&) = default;
};

// The signs of an octant, each 1 or -1.
struct Octant {
  double x = 1, y = 1, z = 1;
};
[[nodiscard]] inline Octant octant_of(Vec3d d) {
  return {std::copysign(1.0, d.x), std::copysign(1.0, d.y), std::copysign(1.0, d.z)};
}

namespace octahedral {

// One coordinate over u, and its gradient. In the octant u, v, w = 1 - u - v >= 0 the direction is along
// (u a(u, v), v a(v, u), w b(u, v)).
inline constexpr double a_u = -.93722, a_v = -.32551, a_uu = .12016, a_uv = .99138, a_vv = -.39742;
inline constexpr double b_0 = .51399, b_1 = .013775, b_2 = -.41058, b_uv = 1.6112;

[[nodiscard]] constexpr double a(double u, double v) {
  return ((1 + (a_u * u + a_v * v)) + (a_uu * u * u + a_vv * v * v)) + a_uv * (u * v);
}
[[nodiscard]] constexpr double b(double u, double v) {
  return ((b_0 + b_1 * (u + v)) + b_2 * (u * u + v * v)) + b_uv * (u * v);
}

// Not normalised; u, v >= 0, u + v <= 1.
[[nodiscard]] constexpr Vec3d along(double u, double v) { return {u * a(u, v), v * a(v, u), (1 - (u + v)) * b(u, v)}; }

}  // namespace octahedral

// A unit vector.
[[nodiscard]] inline Vec3d direction_of(SquarePoint p) {
  const double x = 2 * p.s - 1, y = 1 - 2 * p.t;
  const double across = std::abs(x), up = std::abs(y);
  const bool south = across + up > 1;
  const double u = south ? 1 - up : across, v = south ? 1 - across : up, sign = south ? -1.0 : 1.0;
  const Vec3d q = octahedral::along(u, v);
  const double scale = 1 / std::sqrt((q.x * q.x + q.y * q.y) + q.z * q.z);
  return {std::copysign(scale * q.x, x), std::copysign(scale * q.y, y), sign * (scale * q.z)};
}

// The inverse, for a nonzero d of any length, in the given octant: on a border between octants the caller says which
// one is meant. Newton's method; the result is within 1e-15 of the exact one.
[[nodiscard]] SquarePoint square_point(Vec3d d, const Octant& octant);

// In the octant of d, zeros by their sign.
[[nodiscard]] inline SquarePoint square_point(Vec3d d) { return square_point(d, octant_of(d)); }

}  // namespace lodestone::spherical
