#include "experiments/systems/surface/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lodestone {
namespace {

double farthest(std::span<const Vec3f> points, const TriangleBvh& other, Scheduler& scheduler) {
  constexpr std::size_t grain = 4096;
  std::vector<double> partial(chunk_count(points.size(), grain), 0);
  scheduler.for_chunks(points.size(), grain, [&](ChunkRange range) {
    std::uint32_t hint = TriangleBvh::no_hint;
    for (const Vec3f p : points.subspan(range.begin, range.end - range.begin)) {
      const TriangleBvh::Nearest nearest = other.nearest(to_double(p), hint);
      hint = nearest.slot;
      partial[range.index] = std::max(partial[range.index], nearest.squared_distance);
    }
  });
  double all = 0;
  for (const double squared : partial) all = std::max(all, squared);
  return std::sqrt(all);
}

// Corners and middles in the order of the triangles: points side by side are near each other, as these are.
std::vector<Vec3f> samples_of(const SurfaceView& mesh) {
  std::vector<std::uint8_t> seen(mesh.positions.size(), 0);
  std::vector<Vec3f> samples;
  for (const auto& [v] : mesh.triangles) {
    const Vec3f a = mesh.positions[v[0]], b = mesh.positions[v[1]], c = mesh.positions[v[2]];
    samples.push_back(to_float((1.0 / 3) * (to_double(a) + to_double(b) + to_double(c))));
    for (const std::uint32_t corner : v)
      if (!std::exchange(seen[corner], 1)) samples.push_back(mesh.positions[corner]);
  }
  return samples;
}

}  // namespace

TriangleBvh tree_of(const SurfaceView& mesh) {
  std::vector<Vec3d> places;
  for (const Vec3f p : mesh.positions) places.push_back(to_double(p));
  return {places, mesh.triangles};
}

double surface_distance(const SurfaceView& mesh, std::span<const Vec3f> points, const TriangleBvh& full,
                        Scheduler& scheduler) {
  return std::max(farthest(samples_of(mesh), full, scheduler), farthest(points, tree_of(mesh), scheduler));
}

}  // namespace lodestone
