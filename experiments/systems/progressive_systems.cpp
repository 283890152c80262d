#include "experiments/systems/progressive_systems.h"

#include <cmath>
#include <string>
#include <utility>

#include "experiments/systems/progressive/prefix_ladder.h"
#include "experiments/systems/progressive/split_forest.h"
#include "experiments/systems/surface/patch_hierarchy.h"
#include "experiments/systems/surface/surface_distance.h"
#include "experiments/systems/surface/welded_surface.h"

namespace lodestone {
namespace {

class WholePrefix final : public Patches {
 public:
  WholePrefix(const Hierarchy& model, Scheduler& scheduler) : WholePrefix(model, welded(model), scheduler) {}

  [[nodiscard]] const Hierarchy& hierarchy() const override { return cells_.hierarchy(); }
  [[nodiscard]] bool remakes() const override { return true; }

  [[nodiscard]] std::vector<CellId> select(Vec3f viewpoint, double reach) override {
    place_ = ladder_.place_for(std::sqrt(surface_.nearest(to_double(viewpoint)).squared_distance) / reach);
    positions_ = ladder_.positions_at(place_);
    return cells_.remake({positions_, ladder_.normals_at(place_), ladder_.steps()[place_.step].triangles});
  }

  [[nodiscard]] DrawnPoints drawn_points() const override {
    DrawnPoints drawn{ladder_.points(), {}};
    for (const std::uint32_t v : ladder_.vertex_of_points(place_.step)) drawn.places.push_back(positions_[v]);
    return drawn;
  }

 private:
  static WeldedSurface welded(const Hierarchy& model) { return welded_surface(model, "progressive-whole"); }
  WholePrefix(const Hierarchy& model, const WeldedSurface& surface, Scheduler& scheduler)
      : cells_(model),
        ladder_(surface, model.transform, scheduler),
        surface_(tree_of({surface.positions, surface.triangles})) {}

  PatchHierarchy cells_;
  PrefixLadder ladder_;
  TriangleBvh surface_;
  PrefixLadder::Place place_;
  std::vector<Vec3f> positions_;  // of its vertices
};

class RefinedMesh final : public Patches {
 public:
  RefinedMesh(const Hierarchy& model, Scheduler& scheduler)
      : cells_(model), forest_(welded_surface(model, "vdpm"), model.transform, scheduler) {}

  [[nodiscard]] const Hierarchy& hierarchy() const override { return cells_.hierarchy(); }
  [[nodiscard]] bool remakes() const override { return true; }

  [[nodiscard]] std::vector<CellId> select(Vec3f viewpoint, double reach) override {
    drawn_for_ = forest_.refine(to_double(viewpoint), reach);
    return cells_.remake({forest_.points(), forest_.normals(), forest_.triangles(drawn_for_)});
  }

  [[nodiscard]] DrawnPoints drawn_points() const override {
    DrawnPoints drawn{forest_.points(), {}};
    for (const std::uint32_t v : drawn_for_) drawn.places.push_back(forest_.points()[v]);
    return drawn;
  }

 private:
  PatchHierarchy cells_;
  SplitForest forest_;
  std::vector<std::uint32_t> drawn_for_;
};

}  // namespace

LodSystem progressive_whole_system() {
  LodSystem system =
      patch_system<WholePrefix>("one prefix of a progressive mesh, vertices morphed from prefix to prefix");
  system.keeps_promise = true;
  return system;
}

LodSystem vdpm_system() { return patch_system<RefinedMesh>("a progressive mesh, split where its errors are seen"); }

}  // namespace lodestone
