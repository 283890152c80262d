// A surface taken apart into its components.
#pragma once

#include <vector>

#include "core/spherical/surface.h"

namespace lodestone::spherical {

// One surface for each component of triangles that share vertices, in the order of their first triangles; vertices and
// triangles keep their order. Every vertex has a triangle.
[[nodiscard]] std::vector<Surface> split_components(Surface surface);

}  // namespace lodestone::spherical
