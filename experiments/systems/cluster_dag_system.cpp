#include "experiments/systems/cluster_dag_system.h"

#include <meshoptimizer.h>

#include <utility>

#include "core/base/error.h"
#include "experiments/systems/cluster_dag/cluster_dag.h"

namespace lodestone {
namespace {

struct Surface {
  std::vector<Vec3f> positions;
  std::vector<PackedNormal> normals;
  std::vector<Triangle> triangles;
};

// M_L with one vertex at a place.
Surface welded(const Hierarchy& hierarchy) {
  Surface copies;
  for (const Cell& cell : hierarchy.cells_of(hierarchy.finest())) {
    const auto first = static_cast<std::uint32_t>(copies.positions.size());
    copies.positions.insert(copies.positions.end(), cell.positions.begin(), cell.positions.end());
    copies.normals.insert(copies.normals.end(), cell.normals.begin(), cell.normals.end());
    for (const Triangle& t : cell.triangles)
      copies.triangles.push_back({{first + t.v[0], first + t.v[1], first + t.v[2]}});
  }
  const std::size_t count = copies.positions.size();
  std::vector<unsigned> place(count);
  const std::size_t places =
      meshopt_generateVertexRemap(place.data(), nullptr, count, copies.positions.data(), count, sizeof(Vec3f));
  Surface surface{std::vector<Vec3f>(places), std::vector<PackedNormal>(places), {}};
  for (std::size_t i = 0; i < count; ++i)
    surface.positions[place[i]] = copies.positions[i], surface.normals[place[i]] = copies.normals[i];
  for (const Triangle& t : copies.triangles) {
    const Triangle own{{place[t.v[0]], place[t.v[1]], place[t.v[2]]}};
    if (!is_degenerate(own)) surface.triangles.push_back(own);
  }
  return surface;
}

class ClusterPatches final : public Patches {
 public:
  ClusterPatches(const Hierarchy& model, bool measured, Scheduler& scheduler) {
    const Surface surface = welded(model);
    clusters_ =
        build_cluster_dag(surface.positions, surface.triangles, ClusterDagConfig{.measured = measured}, scheduler);
    hierarchy_.transform = model.transform;
    hierarchy_.materials = model.materials;
    hierarchy_.provenance = model.provenance;
    payloads_.resize(clusters_.size());
    for (std::size_t c = 0; c < clusters_.size(); ++c) add_cell(surface, c);
    hierarchy_.cells.front().bounds = model.cells.front().bounds;
  }

  [[nodiscard]] const Hierarchy& hierarchy() const override { return hierarchy_; }

  [[nodiscard]] std::vector<CellId> select(Vec3f viewpoint, double reach) const override {
    std::vector<CellId> drawn;
    for (std::uint32_t c = 0; c < clusters_.size(); ++c)
      if (is_drawn(clusters_[c], to_double(viewpoint), reach)) drawn.push_back(CellId(c));
    return drawn;
  }

 private:
  struct Payload {
    std::vector<Vec3f> positions;
    std::vector<PackedNormal> normals;
    std::vector<std::uint16_t> indices;
  };

  void add_cell(const Surface& surface, std::size_t number) {
    Payload& payload = payloads_[number];
    Cell cell;
    for (const std::uint32_t v : clusters_[number].vertices) {
      payload.positions.push_back(surface.positions[v]);
      payload.normals.push_back(surface.normals[v]);
      cell.bounds.extend(surface.positions[v]);
    }
    for (const Triangle& t : clusters_[number].triangles)
      for (const std::uint32_t v : t.v) payload.indices.push_back(static_cast<std::uint16_t>(v));
    cell.positions = payload.positions, cell.normals = payload.normals;
    cell.triangles = Triangles(std::span<const std::uint16_t>(payload.indices));
    if (hierarchy_.levels.empty()) hierarchy_.levels.emplace_back();
    Level& level = hierarchy_.levels.front();
    ++level.cell_count, level.triangles += cell.triangles.size(), level.vertices += cell.positions.size();
    hierarchy_.cells.push_back(std::move(cell));
  }

  std::vector<Cluster> clusters_;
  std::vector<Payload> payloads_;
  Hierarchy hierarchy_;
};

}  // namespace

LodSystem cluster_dag_system(bool measured) {
  LodSystem system;
  system.description = measured ? "clusters in groups that are exchanged, by measured errors"
                                : "clusters in groups that are exchanged, by meshoptimizer's errors";
  system.moves_vertices = false;
  system.patches = [measured](const Hierarchy& model, Scheduler& scheduler) -> std::shared_ptr<const Patches> {
    if (model.attributes != AttributeSet{})
      throw InputError(
          "the system cluster-dag draws positions and normals alone; give it a model without textures, "
          "colours and materials");
    return std::make_shared<ClusterPatches>(model, measured, scheduler);
  };
  return system;
}

}  // namespace lodestone
