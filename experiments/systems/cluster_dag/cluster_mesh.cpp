#include "experiments/systems/cluster_dag/cluster_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>

#include "core/math/vec3.h"

namespace lodestone {
namespace {

std::vector<unsigned> indices_of(std::span<const Triangle> triangles) {
  std::vector<unsigned> indices;
  indices.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) indices.insert(indices.end(), t.v.begin(), t.v.end());
  return indices;
}

}  // namespace

std::vector<Cluster> cut_into_clusters(const PartMesh& mesh, const ClusterDagConfig& config) {
  const std::vector<unsigned> indices = indices_of(mesh.triangles);
  const std::size_t most =
      meshopt_buildMeshletsBound(indices.size(), config.cluster_vertices, config.cluster_triangles);
  std::vector<meshopt_Meshlet> made(most);
  std::vector<unsigned> vertices(most * config.cluster_vertices);
  std::vector<unsigned char> corners(most * config.cluster_triangles * 3);
  made.resize(meshopt_buildMeshlets(made.data(), vertices.data(), corners.data(), indices.data(), indices.size(),
                                    &mesh.positions[0].x, mesh.positions.size(), sizeof(Vec3f), config.cluster_vertices,
                                    config.cluster_triangles, 0));
  std::vector<Cluster> clusters(made.size());
  for (std::size_t m = 0; m < made.size(); ++m) {
    Cluster& cluster = clusters[m];
    for (unsigned v = 0; v < made[m].vertex_count; ++v)
      cluster.vertices.push_back(mesh.vertices[vertices[made[m].vertex_offset + v]]);
    const unsigned char* corner = &corners[made[m].triangle_offset];
    for (unsigned t = 0; t < made[m].triangle_count; ++t, corner += 3)
      cluster.triangles.push_back({{corner[0], corner[1], corner[2]}});
  }
  return clusters;
}

// This version of the library locks no vertices but those with several open edges. So each locked vertex gets two
// triangles more, whose edges are open (docs/decisions/0007); their other corners lie in a row across the box of the
// mesh, each in a place of its own, since the library takes vertices in one place for one.
Simplified simplify_to_half(const PartMesh& mesh, std::span<const std::uint8_t> locked) {
  std::vector<unsigned> indices = indices_of(mesh.triangles);
  const auto first_marker = static_cast<unsigned>(mesh.positions.size());
  unsigned markers = 0;
  for (unsigned v = 0; v < first_marker; ++v) {
    if (!locked[v]) continue;
    const unsigned m = first_marker + markers;
    for (const unsigned corner : {v, m, m + 1, v, m, m + 1}) indices.push_back(corner);
    markers += 2;
  }
  Box3f box;
  for (const Vec3f p : mesh.positions) box.extend(p);
  std::vector<Vec3f> positions = mesh.positions;
  for (unsigned m = 0; m < markers; ++m) {
    const float share = (static_cast<float>(m) + 0.5f) / static_cast<float>(markers);
    positions.push_back(box.lo + share * (box.hi - box.lo));
  }
  const std::size_t added = indices.size() - 3 * mesh.triangles.size();
  const std::size_t target = 3 * (mesh.triangles.size() / 2) + added;
  std::vector<unsigned> made(indices.size());
  float error = 0;
  constexpr float any_error = 1e9f;
  made.resize(meshopt_simplify(made.data(), indices.data(), indices.size(), &positions[0].x, positions.size(),
                               sizeof(Vec3f), target, any_error, 0, &error));
  Simplified simplified;
  for (std::size_t i = 0; i + 2 < made.size(); i += 3)
    if (std::max({made[i], made[i + 1], made[i + 2]}) < first_marker)
      simplified.triangles.push_back({{made[i], made[i + 1], made[i + 2]}});
  simplified.error = double{error} * meshopt_simplifyScale(&positions[0].x, positions.size(), sizeof(Vec3f));
  return simplified;
}

}  // namespace lodestone
