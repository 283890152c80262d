// The point of a triangle nearest to a given point, in double, for every triangle: slivers, segments and points too.
#pragma once

#include <algorithm>

#include "core/base/vec3.h"

namespace lodestone {

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

// The distance is always that of `point`, which lies on the triangle within rounding: a normal that is mere noise, as
// slivers have, may cost accuracy of the inside case but never reports less than the true distance; there the edges are
// looked at as well.
[[nodiscard]] inline NearestPoint nearest_on_triangle(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d ab = b - a, ac = c - a, ap = p - a;
  const Vec3d normal = cross(ab, ac);
  const double area2 = squared_length(normal);
  const double wb = dot(cross(ap, ac), normal), wc = dot(cross(ab, ap), normal), wa = area2 - wb - wc;
  const bool inside = wa >= 0 && wb >= 0 && wc >= 0 && area2 > 0;
  NearestPoint best{a, squared_length(ap)};
  if (inside) {
    const Vec3d q = a + (wb / area2) * ab + (wc / area2) * ac;
    best = {q, squared_length(p - q)};
    constexpr double sliver = 1e-12;  // squared sine of an angle whose normal still has about half of its digits
    if (area2 > sliver * squared_length(ab) * squared_length(ac)) return best;
  }
  for (const NearestPoint& other :
       {nearest_on_segment(p, a, b), nearest_on_segment(p, b, c), nearest_on_segment(p, c, a)})
    if (other.squared_distance < best.squared_distance) best = other;
  return best;
}

}  // namespace lodestone
