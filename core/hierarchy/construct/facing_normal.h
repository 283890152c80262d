// One normal for all triangles at a corner of the surface, where their mean would face away from some of them.
//
// On thin parts and in folds that are left of finer levels a vertex has triangles that face far apart, and the mean of
// their normals is more than 60 degrees off some, which are lit as if they were elsewhere. The centre of the smallest
// cap of the sphere that holds the normals is within 60 degrees of all of them if anything is; it is approached by steps
// towards the farthest (badoiu2003). Where no normal is that near to all, the smallest triangles are given up, since
// the least of the picture shows them.
#pragma once

#include <vector>

#include "core/math/vec3.h"

namespace lodestone {

// triangles: the cross products of two sides of each; their lengths are twice the areas. Returns a direction of unit
// length that is within 60 degrees of all triangles but those given up, or zero if no triangle has an area.
// O(n log n) for n triangles, O(n) where all have a normal in common.
[[nodiscard]] Vec3d facing_normal(const std::vector<Vec3d>& triangles);

}  // namespace lodestone
