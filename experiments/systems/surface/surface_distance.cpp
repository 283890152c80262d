#include "experiments/systems/surface/surface_distance.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

template <class PointOf>
double farthest(std::size_t count, const PointOf& point_of, const TriangleBvh& other, Scheduler& scheduler) {
  constexpr std::size_t grain = 4096;
  std::vector<double> partial(chunk_count(count, grain), 0);
  scheduler.for_chunks(count, grain, [&](ChunkRange range) {
    std::uint32_t hint = TriangleBvh::no_hint;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const TriangleBvh::Nearest nearest = other.nearest(point_of(i), hint);
      hint = nearest.slot;
      partial[range.index] = std::max(partial[range.index], nearest.squared_distance);
    }
  });
  double all = 0;
  for (const double squared : partial) all = std::max(all, squared);
  return std::sqrt(all);
}

}  // namespace

TriangleBvh tree_of(const MeshView& mesh) {
  std::vector<Vec3d> places;
  for (const Vec3f p : mesh.positions) places.push_back(to_double(p));
  return {places, mesh.triangles};
}

double surface_distance(const MeshView& mesh, std::span<const Vec3f> points, const TriangleBvh& full,
                        Scheduler& scheduler) {
  const std::size_t vertices = mesh.positions.size();
  const auto of_mesh = [&](std::size_t i) {
    if (i < vertices) return to_double(mesh.positions[i]);
    const auto& [v] = mesh.triangles[i - vertices];
    return (1.0 / 3) *
           (to_double(mesh.positions[v[0]]) + to_double(mesh.positions[v[1]]) + to_double(mesh.positions[v[2]]));
  };
  const TriangleBvh own = tree_of(mesh);
  return std::max(farthest(vertices + mesh.triangles.size(), of_mesh, full, scheduler),
                  farthest(
                      points.size(), [&](std::size_t i) { return to_double(points[i]); }, own, scheduler));
}

}  // namespace lodestone
