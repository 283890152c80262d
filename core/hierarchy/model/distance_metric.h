// The distance d of selection and morph: from the viewpoint to a vertex and to a box.
//
// Both functions do the same operations in the same order, and every one of them is monotone under rounding, so that
// distance(v, box) <= distance(v, x) holds in float for every x in the box: the crack-free proof needs exactly that.
// Compile without contraction of floating point (the build does).
#pragma once

#include <algorithm>
#include <cmath>

#include "core/hierarchy/model/hierarchy.h"
#include "core/math/vec3.h"

namespace lodestone {

// Norm of a vector of non-negative components.
[[nodiscard]] inline float norm(DistanceMetric metric, float ax, float ay, float az) {
  if (metric == DistanceMetric::chebyshev) return std::max(std::max(ax, ay), az);
  return std::sqrt((ax * ax + ay * ay) + az * az);
}

// Norm of any vector, in double: for proofs and measures, not for what is drawn.
[[nodiscard]] inline double norm(DistanceMetric metric, Vec3d v) {
  if (metric == DistanceMetric::chebyshev) return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return length(v);
}

[[nodiscard]] inline float distance(DistanceMetric metric, Vec3f viewpoint, Vec3f p) {
  return norm(metric, std::abs(p.x - viewpoint.x), std::abs(p.y - viewpoint.y), std::abs(p.z - viewpoint.z));
}

[[nodiscard]] inline float distance(DistanceMetric metric, Vec3f viewpoint, const Box3f& box) {
  const auto beyond = [](float lo, float hi, float v) { return std::max(std::max(lo - v, v - hi), 0.0f); };
  return norm(metric, beyond(box.lo.x, box.hi.x, viewpoint.x), beyond(box.lo.y, box.hi.y, viewpoint.y),
              beyond(box.lo.z, box.hi.z, viewpoint.z));
}

// From p to the corner of the box that is farthest from it.
[[nodiscard]] inline float farthest_corner_distance(DistanceMetric metric, Vec3f p, const Box3f& box) {
  const auto far = [](float lo, float hi, float v) { return std::max(std::abs(v - lo), std::abs(hi - v)); };
  return norm(metric, far(box.lo.x, box.hi.x, p.x), far(box.lo.y, box.hi.y, p.y), far(box.lo.z, box.hi.z, p.z));
}

}  // namespace lodestone
