#include "experiments/metrics/drawn/screen_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "experiments/metrics/drawn/position_resolution.h"
#include "experiments/metrics/drawn/screen.h"

namespace lodestone {
namespace {

struct Farthest {
  double pixels = 0;
  std::uint64_t points = 0;
};

// Largest distance on the screen of `count` points inside the picture from their nearest points of `other`.
template <class PointOf>
Farthest farthest(std::size_t count, const PointOf& point_of, const TriangleBvh& other, const Screen& screen,
                  Scheduler& scheduler) {
  constexpr std::size_t grain = 4096;
  std::vector<Farthest> partial(chunk_count(count, grain));
  scheduler.for_chunks(count, grain, [&](ChunkRange range) {
    Farthest& own = partial[range.index];
    std::uint32_t hint = TriangleBvh::no_hint;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const Vec3d p = point_of(i);
      const auto from = screen.project(p);
      if (!from || !from->inside) continue;
      const TriangleBvh::Nearest nearest = other.nearest(p, hint);
      hint = nearest.slot;
      ++own.points;
      if (resolved(std::sqrt(nearest.squared_distance)) == 0) continue;
      if (const auto to = screen.project(nearest.point)) own.pixels = std::max(own.pixels, distance(*from, *to));
    }
  });
  Farthest all;
  for (const Farthest& f : partial) all = {std::max(all.pixels, f.pixels), all.points + f.points};
  return all;
}

}  // namespace

ScreenError screen_error(const MeasuredSurface& drawn, const MeasuredSurface& full, const Screen& screen,
                         Scheduler& scheduler) {
  const DrawnMesh& mesh = drawn.mesh();
  const std::size_t vertices = mesh.positions.size();
  const auto drawn_point = [&](std::size_t i) {
    if (i < vertices) return mesh.positions[i];
    const Triangle& t = mesh.triangles[i - vertices];
    return (1.0 / 3) * (mesh.positions[t.v[0]] + mesh.positions[t.v[1]] + mesh.positions[t.v[2]]);
  };
  const auto full_point = [&](std::size_t i) { return full.mesh().positions[i]; };
  const Farthest there = farthest(vertices + mesh.triangles.size(), drawn_point, full.tree(), screen, scheduler);
  const Farthest back = farthest(full.mesh().positions.size(), full_point, drawn.tree(), screen, scheduler);
  return {there.pixels, back.pixels, there.points + back.points};
}

}  // namespace lodestone
