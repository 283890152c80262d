// Comparing two meshes with all workers: same bytes as core/distance/mesh_distance.h.
#pragma once

#include "core/distance/mesh_distance.h"
#include "parallel/scheduler.h"

namespace lodestone {

// As compare_meshes; the two search structures are built side by side, the samples are measured in chunks.
[[nodiscard]] MeshDistance compare_meshes(const RawMesh& a, const RawMesh& b, const CompareConfig& config,
                                          Scheduler& scheduler);

}  // namespace lodestone
