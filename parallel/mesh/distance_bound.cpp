#include "parallel/mesh/distance_bound.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "core/base/sort_unique.h"
#include "core/hierarchy/construct/cell_error.h"
#include "core/hierarchy/model/cell_code.h"
#include "core/math/round_up.h"

namespace lodestone {
namespace {

constexpr std::size_t cell_triangles = 2048;
constexpr std::size_t triangle_grain = 4096;
constexpr int curve_level = 10;              // of the cells along the Morton curve
constexpr double negligible = 1e-6;          // some sixteen times the rounding of positions
constexpr double tests_per_triangle = 1200;  // at most, as of MeasureConfig; needles need a limit

// Neighbours on the surface are mostly neighbours in the order.
std::vector<Triangle> along_curve(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                                  Scheduler& scheduler) {
  std::vector<std::pair<CellCode, std::uint32_t>> order(triangles.size());
  scheduler.for_chunks(triangles.size(), triangle_grain, [&](ChunkRange range) {
    for (std::size_t t = range.begin; t < range.end; ++t) {
      const auto& v = triangles[t].v;
      const Vec3f middle = barycentre(positions[v[0]], positions[v[1]], positions[v[2]]);
      order[t] = {CellCode::from(cell_of(middle, curve_level)), static_cast<std::uint32_t>(t)};
    }
  });
  std::sort(order.begin(), order.end());
  std::vector<Triangle> sorted;
  sorted.reserve(triangles.size());
  for (const auto& [code, t] : order) sorted.push_back(triangles[t]);
  return sorted;
}

// Numbers the vertices of these triangles anew; returns their positions.
std::vector<Vec3f> pack(std::span<Triangle> triangles, std::span<const Vec3f> positions) {
  std::vector<std::uint32_t> used;
  for (const Triangle& t : triangles) used.insert(used.end(), t.v.begin(), t.v.end());
  sort_unique(used);
  for (Triangle& t : triangles)
    for (std::uint32_t& v : t.v)
      v = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin());
  std::vector<Vec3f> packed;
  for (const std::uint32_t v : used) packed.push_back(positions[v]);
  return packed;
}

}  // namespace

BoundedSurface::BoundedSurface(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                               Scheduler& scheduler)
    : triangles_(along_curve(positions, triangles, scheduler)),
      positions_(chunk_count(triangles.size(), cell_triangles)) {
  hierarchy_.cells.resize(positions_.size());
  hierarchy_.levels.resize(1);
  hierarchy_.levels[0].cell_count = static_cast<std::uint32_t>(positions_.size());
  surface_.emplace(hierarchy_, 0);
  scheduler.for_chunks(triangles_.size(), cell_triangles, [&](ChunkRange range) {
    const std::span<Triangle> part = std::span(triangles_).subspan(range.begin, range.end - range.begin);
    positions_[range.index] = pack(part, positions);
    Cell& cell = hierarchy_.cells[range.index];
    cell.triangles = part;
    cell.positions = positions_[range.index];
    surface_->build_cell(CellRank(range.index));
  });
  surface_->build_rest();
}

double distance_bound(const BoundedSurface& a, const BoundedSurface& b, double enough, Scheduler& scheduler) {
  std::vector<double> bounds(a.cells());
  scheduler.for_chunks(a.cells(), 1, [&](ChunkRange range) {
    const CellRank first(range.index * b.cells() / a.cells()), end((range.index + 1) * b.cells() / a.cells());
    std::size_t triangles = a.surface().triangle_count(CellRank(range.index));
    for (CellRank c = first; c < end; ++c) triangles += b.surface().triangle_count(c);
    CellErrorMeter meter;
    bounds[range.index] =
        meter
            .measure(
                {.level = a.surface(),
                 .cell = CellRank(range.index),
                 .finest = b.surface(),
                 .first = first,
                 .end = end,
                 .known = enough,
                 .negligible = negligible,
                 .tests = static_cast<std::uint64_t>(std::ceil(tests_per_triangle * static_cast<double>(triangles)))})
            .bound;
  });
  return sum_up(*std::max_element(bounds.begin(), bounds.end()), distance_rounding);
}

}  // namespace lodestone
