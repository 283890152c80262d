// One group of clusters as a mesh: cut into clusters, and simplified with some of its vertices in place. By
// meshoptimizer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "experiments/systems/cluster_dag/cluster_dag.h"

namespace lodestone {

// Triangles of a part of a surface: `vertices` are those of the surface, ascending, `triangles` places among them.
struct ClusterMesh {
  std::vector<std::uint32_t> vertices;
  std::vector<Vec3f> positions;  // of `vertices`
  std::vector<Triangle> triangles;
};

// Triangles have vertices of the surface.
[[nodiscard]] ClusterMesh cluster_mesh(std::span<const Triangle> triangles, std::span<const Vec3f> surface);

// Clusters of at most so many triangles and vertices, without balls.
[[nodiscard]] std::vector<Cluster> cut_into_clusters(const ClusterMesh& mesh, const ClusterDagConfig& config);

struct Simplified {
  std::vector<Triangle> triangles;  // of places in the mesh's vertices
  double error = 0;                 // meshoptimizer's estimate, in units of the positions
};

// To half of the triangles, or as far as it goes. `locked`: by vertex of the mesh, 1 for those that stay.
[[nodiscard]] Simplified simplify_to_half(const ClusterMesh& mesh, std::span<const std::uint8_t> locked);

}  // namespace lodestone
