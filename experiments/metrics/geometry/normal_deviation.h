// Angles between the normals of two surfaces: at points spread over the area of the one (core/spatial), the normal
// of the triangle there against that of the triangle of the other which is nearest.
#pragma once

#include <cstdint>

#include "core/mesh/indexed_mesh.h"
#include "core/spatial/mesh_distance.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Degrees in [0, 180], over the area points; those whose triangle here or there has no normal are left out.
struct DirectedDeviation {
  double mean = 0, p99 = 0, max = 0;
  std::uint64_t samples = 0;  // with two normals
};

struct NormalDeviation {
  DirectedDeviation forward, backward;  // from the first mesh to the second; from the second to the first
};

// Throws what compare_meshes throws. The same bytes for any number of workers.
[[nodiscard]] NormalDeviation normal_deviation(const RawMesh& a, const RawMesh& b, const CompareConfig& config,
                                               Scheduler& scheduler);

}  // namespace lodestone
