// How much of a surface another one covers.
#pragma once

#include <span>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler.h"

namespace lodestone {

// The share of the points, in normalised space, that have a point of the mesh within `distance` (normalised units). 0
// for a mesh without triangles, 1 for no points.
[[nodiscard]] double coverage(std::span<const Vec3d> points, const RawMesh& mesh, const Transform& transform,
                              double distance, Scheduler& scheduler);

}  // namespace lodestone
