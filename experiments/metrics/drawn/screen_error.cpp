#include "experiments/metrics/drawn/screen_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "experiments/metrics/drawn/drawn_mesh.h"
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

TriangleBvh bvh_of(const DrawnMesh& mesh) { return TriangleBvh(mesh.positions, mesh.triangles); }

}  // namespace

ScreenErrorBasis::ScreenErrorBasis(const Hierarchy& hierarchy) : full_(bvh_of(finest_mesh(hierarchy))) {}

ScreenError screen_error(const MorphContext& morph, const Selection& selection, const ViewProjection& view_projection,
                         ImageSize size, const ScreenErrorBasis& basis, Scheduler& scheduler) {
  const Screen screen(view_projection, size);
  const DrawnMesh drawn = drawn_mesh(morph, selection);
  ScreenError error;
  if (drawn.triangles.empty()) return error;
  const std::size_t vertices = drawn.positions.size();
  const auto drawn_point = [&](std::size_t i) {
    if (i < vertices) return drawn.positions[i];
    const Triangle& t = drawn.triangles[i - vertices];
    return (1.0 / 3) * (drawn.positions[t.v[0]] + drawn.positions[t.v[1]] + drawn.positions[t.v[2]]);
  };
  const Farthest there = farthest(vertices + drawn.triangles.size(), drawn_point, basis.full(), screen, scheduler);
  const TriangleBvh drawn_bvh = bvh_of(drawn);
  error.drawn_to_full = there.pixels;
  error.points = there.points;
  for (const Cell& cell : morph.hierarchy->cells_of(morph.hierarchy->finest())) {
    const Farthest back = farthest(
        cell.positions.size(), [&](std::size_t i) { return to_double(cell.positions[i]); }, drawn_bvh, screen,
        scheduler);
    error.full_to_drawn = std::max(error.full_to_drawn, back.pixels);
    error.points += back.points;
  }
  return error;
}

}  // namespace lodestone
