#include "experiments/metrics/surface_coverage.h"

#include <atomic>
#include <vector>

#include "core/distance/triangle_bvh.h"

namespace lodestone {

double coverage(std::span<const Vec3d> points, const RawMesh& mesh, const Transform& transform, double distance,
                Scheduler& scheduler) {
  if (points.empty()) return 1;
  if (mesh.triangles.empty()) return 0;
  std::vector<Vec3d> positions;
  positions.reserve(mesh.positions.size());
  for (const Vec3d& p : mesh.positions) positions.push_back((1 / transform.scale) * (p - transform.origin));
  const TriangleBvh bvh(positions, mesh.triangles);
  std::atomic<std::size_t> near{0};
  scheduler.for_chunks(points.size(), 1024, [&](ChunkRange range) {
    std::size_t own = 0;
    for (std::size_t k = range.begin; k < range.end; ++k)
      own += bvh.nearest(points[k]).squared_distance <= distance * distance;
    near += own;
  });
  return static_cast<double>(near) / static_cast<double>(points.size());
}

}  // namespace lodestone
