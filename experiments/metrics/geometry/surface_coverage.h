// Share of a surface that another one covers.
#pragma once

#include <span>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct SurfaceCoverage {
  double share = 0;         // of the points that have a point of the mesh within the distance
  double rms = 0, max = 0;  // of the points' distances from the mesh, normalised units
};

// Points are in normalised space, `distance` in normalised units. A mesh without triangles covers nothing, at infinite
// distance; no points are covered, at distance 0. Same bytes for any number of workers.
[[nodiscard]] SurfaceCoverage measure_coverage(std::span<const Vec3d> points, const RawMesh& mesh,
                                               const Transform& transform, double distance, Scheduler& scheduler);

}  // namespace lodestone
