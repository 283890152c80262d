// The distance of a simplified mesh from what it was made of: the largest one of vertices in one direction, and of
// vertices and middles of triangles in the other.
#pragma once

#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "core/spatial/triangle_bvh.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct SurfaceView {
  std::span<const Vec3f> positions;
  std::span<const Triangle> triangles;  // at least one
};

[[nodiscard]] TriangleBvh tree_of(const SurfaceView& mesh);

// `points`: the vertices that the mesh stands for; `full`: the surface that they are of. Several times faster where
// points, and triangles, are near those beside them.
[[nodiscard]] double surface_distance(const SurfaceView& mesh, std::span<const Vec3f> points, const TriangleBvh& full,
                                      Scheduler& scheduler);

}  // namespace lodestone
