#include "experiments/metrics/geometry/surface_coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/spatial/triangle_bvh.h"

namespace lodestone {

SurfaceCoverage measure_coverage(std::span<const Vec3d> points, const RawMesh& mesh, const Transform& transform,
                                 double distance, Scheduler& scheduler) {
  constexpr double never = std::numeric_limits<double>::infinity();
  if (points.empty()) return {1, 0, 0};
  if (mesh.triangles.empty()) return {0, never, never};
  std::vector<Vec3d> positions;
  positions.reserve(mesh.positions.size());
  for (const Vec3d& p : mesh.positions) positions.push_back((1 / transform.scale) * (p - transform.origin));
  const TriangleBvh bvh(positions, mesh.triangles);
  struct Part {
    std::size_t near = 0;
    double sum = 0, max = 0;
  };
  constexpr std::size_t grain = 1024;
  std::vector<Part> parts(chunk_count(points.size(), grain));
  scheduler.for_chunks(points.size(), grain, [&](ChunkRange range) {
    Part& own = parts[range.index];
    for (std::size_t k = range.begin; k < range.end; ++k) {
      const double squared = bvh.nearest(points[k]).squared_distance;
      own.near += squared <= distance * distance, own.sum += squared, own.max = std::max(own.max, squared);
    }
  });
  Part all;
  for (const Part& p : parts) all = {all.near + p.near, all.sum + p.sum, std::max(all.max, p.max)};
  const auto count = static_cast<double>(points.size());
  return {static_cast<double>(all.near) / count, std::sqrt(all.sum / count), std::sqrt(all.max)};
}

}  // namespace lodestone
