#include "experiments/systems/cluster_dag_system.h"

#include <string>

#include "experiments/systems/cluster_dag/cluster_dag.h"
#include "experiments/systems/surface/patch_hierarchy.h"
#include "experiments/systems/surface/welded_surface.h"

namespace lodestone {
namespace {

class ClusterPatches final : public Patches {
 public:
  ClusterPatches(const Hierarchy& model, bool measured, Scheduler& scheduler) : cells_(model) {
    const WeldedSurface surface = welded_surface(model, "cluster-dag");
    clusters_ =
        build_cluster_dag(surface.positions, surface.triangles, ClusterDagConfig{.measured = measured}, scheduler);
    std::vector<Vec3f> positions;
    std::vector<PackedNormal> normals;
    for (const Cluster& cluster : clusters_) {
      positions.clear(), normals.clear();
      for (const std::uint32_t v : cluster.vertices)
        positions.push_back(surface.positions[v]), normals.push_back(surface.normals[v]);
      ids_.push_back(cells_.add({positions, normals, cluster.triangles}));
    }
  }

  [[nodiscard]] const Hierarchy& hierarchy() const override { return cells_.hierarchy(); }

  [[nodiscard]] std::vector<CellId> select(Vec3f viewpoint, double reach) override {
    std::vector<CellId> drawn;
    for (std::size_t c = 0; c < clusters_.size(); ++c)
      if (is_drawn(clusters_[c], to_double(viewpoint), reach)) drawn.push_back(ids_[c]);
    return drawn;
  }

 private:
  std::vector<Cluster> clusters_;
  std::vector<CellId> ids_;  // by cluster
  PatchHierarchy cells_;
};

}  // namespace

LodSystem cluster_dag_system(bool measured) {
  const std::string clusters = "clusters in groups that are exchanged, by ";
  LodSystem system =
      patch_system<ClusterPatches>(clusters + (measured ? "measured errors" : "meshoptimizer's errors"), measured);
  system.moves_vertices = false;
  return system;
}

}  // namespace lodestone
