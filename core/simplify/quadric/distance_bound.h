// Distances in double precision, for the kernel that has single precision; not inline, as that is compiled for several
// processors.
#pragma once

#include "core/simplify/quadric/block_arrays.h"

namespace lodestone::quadric {

// A bound of the squared distance of q from the triangle a, b, c: the distance itself, rounded up to single precision.
[[nodiscard]] float squared_distance_bound(Vec3f q, const AlignedPoint& a, const AlignedPoint& b,
                                           const AlignedPoint& c);

}  // namespace lodestone::quadric
