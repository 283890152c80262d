// View-dependent refinement of a progressive mesh (hoppe1997): the vertex splits that a viewpoint asks for, and those
// that these depend on.
//
// A split is legal where all vertices are active that its vertex has as neighbours when the whole mesh is refined so
// far (xia1996), which includes those that Hoppe's four neighbouring faces ask for. Then the triangles that it replaces
// are there, and every triangle that is drawn is one of some prefix, so that no triangle turns over that does not do so
// there. Set by set, not split by split: what a viewpoint asks for is found anew for each, so that it does not depend
// on the way there; Hoppe goes on from the frame before.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/id.h"
#include "core/progressive/mesh/progressive_mesh.h"
#include "experiments/systems/surface/welded_surface.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

class SplitForest {
 public:
  // Throws what make_progressive throws. Some 5 microseconds a triangle.
  SplitForest(const WeldedSurface& surface, const Transform& transform, Scheduler& scheduler);

  // While the vertex is missing: the largest distance between the triangles that close its place and the surface, both
  // ways, and a ball around these triangles and the vertices that they stand for.
  struct Missing {
    double error = 0;
    Vec3d centre;
    double radius = 0;
  };

  [[nodiscard]] std::uint32_t base_vertices() const { return mesh_.base_vertices; }
  [[nodiscard]] std::span<const Vec3f> points() const { return mesh_.positions; }
  [[nodiscard]] std::span<const PackedNormal> normals() const { return normals_; }
  // The vertices that a split depends on: numbers below its own; none for the base.
  [[nodiscard]] std::span<const std::uint32_t> needs(VertexId vertex) const {
    return std::span(needs_).subspan(first_need_[vertex], first_need_[vertex + 1] - first_need_[vertex]);
  }

  // By vertex: the one that is drawn for it, itself if it is active. An error of 1 is within the tolerance from `reach`
  // on.
  [[nodiscard]] std::vector<std::uint32_t> refine(Vec3d viewpoint, double reach) const;
  // The triangles of such a front, in a coherent order.
  [[nodiscard]] std::vector<Triangle> triangles(std::span<const std::uint32_t> drawn_for) const;

 private:
  void replay();

  ProgressiveMesh mesh_;
  std::vector<std::uint32_t> groups_;  // activation.h: vertices at one place, which come in together
  std::vector<Triangle> triangles_;    // of the finest level, coherent
  std::vector<PackedNormal> normals_;
  std::vector<Missing> missing_;  // by group
  std::vector<std::uint32_t> needs_, first_need_;
};

}  // namespace lodestone
