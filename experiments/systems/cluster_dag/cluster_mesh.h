// One group of clusters as a mesh: cut into clusters, and simplified with some of its vertices in place. By
// meshoptimizer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "experiments/systems/cluster_dag/cluster_dag.h"
#include "experiments/systems/surface/part_mesh.h"

namespace lodestone {

// Clusters of at most so many triangles and vertices, without balls.
[[nodiscard]] std::vector<Cluster> cut_into_clusters(const PartMesh& mesh, const ClusterDagConfig& config);

struct Simplified {
  std::vector<Triangle> triangles;  // of places in the mesh's vertices
  double error = 0;                 // meshoptimizer's estimate, in units of the positions
};

// To half of the triangles, or as far as it goes. `locked`: by vertex of the mesh, 1 for those that stay.
[[nodiscard]] Simplified simplify_to_half(const PartMesh& mesh, std::span<const std::uint8_t> locked);

}  // namespace lodestone
