// Prefixes of a progressive mesh (hoppe1996) with measured errors, and geomorphs from each to the next coarser one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/progressive/mesh/level.h"
#include "core/progressive/mesh/progressive_mesh.h"
#include "experiments/systems/surface/welded_surface.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// A prefix: its vertices where they are best for it (core/progressive/mesh/placement.h), and as it becomes the next.
struct LadderStep {
  double error = 0;  // largest distance from the surface, both ways, and at least that of the finer steps
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;      // in a coherent order
  std::vector<std::uint32_t> ancestor;  // of its vertices, on the next coarser step; empty for the coarsest
};

class PrefixLadder {
 public:
  // From step to step triangles decrease by a factor of the square root of two, or more where the error would hardly
  // grow, down to some 100, or to what does not collapse. Throws what make_progressive throws.
  PrefixLadder(const WeldedSurface& surface, const Transform& transform, Scheduler& scheduler);
  PrefixLadder(const PrefixLadder&) = delete;
  PrefixLadder& operator=(const PrefixLadder&) = delete;

  [[nodiscard]] std::span<const LadderStep> steps() const { return steps_; }  // finest first
  // The vertices of the finest step, and the normals of all.
  [[nodiscard]] std::span<const Vec3f> points() const { return mesh_.positions; }
  [[nodiscard]] std::span<const PackedNormal> normals() const { return normals_; }

  // A step on its way to the next coarser one, by `share` in [0, 1).
  struct Place {
    std::size_t step = 0;
    double share = 0;
  };
  // The coarsest that is off by no more than `error`, if the error of a geomorph grows in proportion to its share.
  [[nodiscard]] Place place_for(double error) const;
  [[nodiscard]] std::vector<Vec3f> positions_at(const Place& place) const;
  [[nodiscard]] std::vector<PackedNormal> normals_at(const Place& place) const;
  // By point: the vertex of a step that stands for it.
  [[nodiscard]] std::vector<std::uint32_t> vertex_of_points(std::size_t step) const;

 private:
  ProgressiveMesh mesh_;
  LevelFinder levels_;
  std::vector<PackedNormal> normals_;
  std::vector<LadderStep> steps_;
};

}  // namespace lodestone
