// A point and a triangle, in double: its barycentric weights, and the point of the triangle nearest to it, for every
// triangle: slivers, segments and points too.
#pragma once

#include <algorithm>
#include <array>

#include "core/math/vec3.h"

namespace lodestone {

// Barycentric weights of a point in the plane of a triangle; thirds if it has no area.
[[nodiscard]] inline std::array<double, 3> barycentric(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d normal = cross(b - a, c - a);
  const double whole = dot(normal, normal);
  if (!(whole > 0)) return {1.0 / 3, 1.0 / 3, 1.0 / 3};
  const double second = dot(cross(p - a, c - a), normal) / whole, third = dot(cross(b - a, p - a), normal) / whole;
  return {1 - second - third, second, third};
}

struct NearestPoint {
  Vec3d point;
  double squared_distance = 0;
};

[[nodiscard]] inline double squared_length(Vec3d a) { return dot(a, a); }

[[nodiscard]] inline NearestPoint nearest_on_segment(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d ab = b - a;
  const double along = dot(p - a, ab), whole = dot(ab, ab);
  const Vec3d q = !(along > 0) || !(whole > 0) ? a : along >= whole ? b : a + (along / whole) * ab;
  return {q, squared_length(p - q)};
}

// The foot of the perpendicular, if it is in the triangle, for slivers: by the longest edge and the height over it,
// which keep their digits where the cross product of two edges has lost them. `best` is replaced by what is nearer.
inline void consider_inside(Vec3d p, std::array<Vec3d, 3> corners, NearestPoint& best) {
  const auto length2 = [&](std::size_t k) { return squared_length(corners[(k + 1) % 3] - corners[k]); };
  const std::size_t base = length2(0) >= length2(1)   ? (length2(0) >= length2(2) ? 0 : 2)
                           : length2(1) >= length2(2) ? 1
                                                      : 2;
  const Vec3d a = corners[base], ab = corners[(base + 1) % 3] - a, ac = corners[(base + 2) % 3] - a, ap = p - a;
  const double whole = dot(ab, ab);
  if (!(whole > 0)) return;
  const double top = dot(ac, ab) / whole;
  Vec3d height = ac - top * ab;
  height = height - (dot(height, ab) / whole) * ab;
  const double height2 = dot(height, height);
  if (!(height2 > 0)) return;
  const double along = dot(ap, ab) / whole, up = dot(ap, height) / height2;
  if (!(up >= 0 && up <= 1 && along >= top * up && along <= 1 - (1 - top) * up)) return;
  const Vec3d q = a + along * ab + up * height;
  if (const double distance2 = squared_length(p - q); distance2 < best.squared_distance) best = {q, distance2};
}

// The distance is always that of `point`, which lies on the triangle within rounding: the inaccurate normal of a sliver
// never leads to less than the true distance. All three edges of a sliver are examined; of any other triangle only
// those that the point lies outside of, since the nearest point is on one of them.
[[nodiscard]] inline NearestPoint nearest_on_triangle(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d ab = b - a, ac = c - a, ap = p - a;
  const Vec3d normal = cross(ab, ac);
  // Barycentric coordinates of the foot of the perpendicular, times `area2`.
  const double area2 = squared_length(normal);
  const double wb = dot(cross(ap, ac), normal), wc = dot(cross(ab, ap), normal), wa = area2 - wb - wc;
  constexpr double sliver_sine2 = 1e-8;  // beyond it the normal has lost at most four of its sixteen digits
  const bool sliver = !(area2 > sliver_sine2 * squared_length(ab) * squared_length(ac));
  NearestPoint best{a, squared_length(ap)};
  if (area2 > 0 && wa >= 0 && wb >= 0 && wc >= 0) {
    const Vec3d q = a + (wb / area2) * ab + (wc / area2) * ac;
    best = {q, squared_length(p - q)};
    if (!sliver) return best;
  }
  const auto consider = [&](Vec3d from, Vec3d to) {
    const NearestPoint other = nearest_on_segment(p, from, to);
    if (other.squared_distance < best.squared_distance) best = other;
  };
  if (sliver || wc < 0) consider(a, b);
  if (sliver || wa < 0) consider(b, c);
  if (sliver || wb < 0) consider(c, a);
  if (sliver) consider_inside(p, {a, b, c}, best);
  return best;
}

}  // namespace lodestone
