#include "experiments/metrics/geometry/surface_coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/spatial/triangle_bvh.h"
#include "render/position_map/map_view.h"
#include "render/reconstruct/views/choose_views.h"

namespace lodestone {
namespace {

// The start of ray k of a direction: a point of the disc of `radius` around the eye, in front of the whole mesh. Points
// follow the R2 sequence, shifted from direction to direction.
Vec3d ray_start(const MapView& view, double radius, std::size_t direction, std::size_t k) {
  const auto fraction = [](double x) { return x - std::floor(x); };
  const double u = fraction(0.5 + 0.7548776662466927 * static_cast<double>(k) +
                            0.6180339887 * static_cast<double>(direction)),
               v = fraction(0.5 + 0.5698402909980532 * static_cast<double>(k) +
                            0.4142135623 * static_cast<double>(direction));
  const double r = radius * std::sqrt(u), angle = 2 * std::numbers::pi * v;
  return view.eye + r * std::cos(angle) * view.right + r * std::sin(angle) * view.up;
}

}  // namespace

std::vector<Vec3d> points_in_pictures(const IndexedMesh& mesh, const Pictures& pictures, Scheduler& scheduler) {
  if (mesh.triangles.empty()) return {};
  std::vector<Vec3d> positions;
  positions.reserve(mesh.positions.size());
  Box3f box;
  for (const Vec3f& p : mesh.positions) positions.push_back(to_double(p)), box.extend(p);
  const TriangleBvh bvh(positions, mesh.triangles);
  const double radius = 0.5 * length(to_double(box.hi) - to_double(box.lo));
  const std::vector<Vec3d> directions = sphere_directions(pictures.directions);
  std::vector<std::vector<Vec3d>> seen(directions.size());
  scheduler.for_chunks(directions.size(), 4, [&](ChunkRange range) {
    for (std::size_t d = range.begin; d < range.end; ++d) {
      const MapView view = orthographic_view(box, directions[d], 1.0);
      for (std::size_t k = 0; k < static_cast<std::size_t>(pictures.rays); ++k) {
        const Vec3d from = ray_start(view, radius, d, k);
        const double t = bvh.meet(from, view.forward, 0);
        if (std::isfinite(t)) seen[d].push_back(from + t * view.forward);
      }
    }
  });
  std::vector<Vec3d> points;
  for (const auto& own : seen) points.insert(points.end(), own.begin(), own.end());
  return points;
}

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
