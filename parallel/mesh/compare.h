// Comparing two meshes with all workers: same bytes as core/spatial/mesh_distance.h.
#pragma once

#include "core/spatial/mesh_distance.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// As compare_meshes; the two search structures are built side by side, the samples are measured in chunks.
[[nodiscard]] MeshDistance compare_meshes(const RawMesh& a, const RawMesh& b, const CompareConfig& config,
                                          Scheduler& scheduler);

}  // namespace lodestone
