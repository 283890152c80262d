// A mesh against its reference, by all measures at once.
#pragma once

#include "core/spatial/mesh_distance.h"
#include "experiments/metrics/geometry/mesh_quality.h"
#include "experiments/metrics/geometry/normal_deviation.h"

namespace lodestone {

struct GeometryError {
  MeshDistance distance;    // forward: from the reference to the mesh; model units; beside the reference's diagonal
  NormalDeviation normals;  // in the same order
  MeshQuality quality;      // of the mesh
  // The larger of both directions, over the diagonal of the reference's box; 0 where that has no extent.
  double hausdorff = 0, rms = 0, mean = 0, p99 = 0;
};

// Throws what compare_meshes throws. The same bytes for any number of workers.
[[nodiscard]] GeometryError geometry_error(const RawMesh& reference, const RawMesh& mesh, const CompareConfig& config,
                                           Scheduler& scheduler);

}  // namespace lodestone
