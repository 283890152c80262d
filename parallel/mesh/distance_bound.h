// A bound of the distance of two surfaces from each other, both ways: no point of one is farther from the other.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/hierarchy/construct/level_surface.h"
#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// A surface about the size of the unit cube, as a search structure: about 100 bytes per triangle.
class BoundedSurface {
 public:
  // At least one triangle, none with two equal corners.
  BoundedSurface(std::span<const Vec3f> positions, std::span<const Triangle> triangles, Scheduler& scheduler);
  BoundedSurface(const BoundedSurface&) = delete;
  BoundedSurface& operator=(const BoundedSurface&) = delete;

  [[nodiscard]] const LevelSurface& surface() const { return *surface_; }
  [[nodiscard]] std::size_t cells() const { return hierarchy_.cells.size(); }
  [[nodiscard]] std::size_t triangles() const { return triangles_.size(); }

 private:
  Hierarchy hierarchy_;  // of one level; its cells hold consecutive triangles along a Morton curve
  std::vector<Triangle> triangles_;
  std::vector<std::vector<Vec3f>> positions_;  // by cell
  std::optional<LevelSurface> surface_;
};

// At most 5 % or 1e-6 more than the largest distance, whichever is larger, or `enough`, below which distances need not
// be told apart; more on surfaces full of needles (core/hierarchy/construct/cell_error.h). The same for any number of
// workers.
[[nodiscard]] double distance_bound(const BoundedSurface& a, const BoundedSurface& b, double enough,
                                    Scheduler& scheduler);

}  // namespace lodestone
