// Distance of the drawn from the full surface on the screen, which --pixel-error bounds.
//
// Points of either surface inside the picture are taken to the nearest point of the other one; both are projected, and
// the distance of the two in the picture counts. Points of the drawn surface are its vertices and the centres of its
// triangles, those of the full one its vertices. Points that are nearer than positions are exact
// (position_resolution.h) have no distance.
#pragma once

#include <cstdint>
#include <utility>

#include "core/spatial/triangle_bvh.h"
#include "experiments/metrics/drawn/drawn_mesh.h"
#include "experiments/metrics/drawn/screen.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct ScreenError {
  double drawn_to_full = 0, full_to_drawn = 0;  // largest, pixels
  std::uint64_t points = 0;                     // looked at
  [[nodiscard]] double largest() const { return drawn_to_full > full_to_drawn ? drawn_to_full : full_to_drawn; }
};

// A surface to measure from and to: about 150 bytes per triangle.
class MeasuredSurface {
 public:
  explicit MeasuredSurface(DrawnMesh mesh) : mesh_(std::move(mesh)), tree_(mesh_.positions, mesh_.triangles) {}
  [[nodiscard]] const DrawnMesh& mesh() const { return mesh_; }
  [[nodiscard]] const TriangleBvh& tree() const { return tree_; }

 private:
  DrawnMesh mesh_;
  TriangleBvh tree_;
};

// The two surfaces have triangles and lie in one space, such as a drawn one and finest_mesh(). O(triangles in sight)
// nearest-point queries.
[[nodiscard]] ScreenError screen_error(const MeasuredSurface& drawn, const MeasuredSurface& full, const Screen& screen,
                                       Scheduler& scheduler);

}  // namespace lodestone
