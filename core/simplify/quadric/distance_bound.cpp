#include "core/simplify/quadric/distance_bound.h"

#include "core/math/round_up.h"
#include "core/spatial/point_triangle.h"

namespace lodestone::quadric {

float squared_distance_bound(Vec3f q, const AlignedPoint& a, const AlignedPoint& b, const AlignedPoint& c) {
  const auto at = [](const AlignedPoint& p) { return Vec3d{p.x, p.y, p.z}; };
  const double squared = nearest_on_triangle(to_double(q), at(a), at(b), at(c)).squared_distance;
  return float_above(squared);
}

}  // namespace lodestone::quadric
