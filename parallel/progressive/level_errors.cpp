#include "parallel/progressive/level_errors.h"

#include <algorithm>
#include <cmath>

#include "core/math/round_up.h"

namespace lodestone {

LevelErrors::LevelErrors(const ProgressiveMesh& mesh, const LevelFinder& levels, Scheduler& scheduler)
    : mesh_(mesh), levels_(levels), scheduler_(scheduler), finest_(mesh.positions, mesh.triangles, scheduler) {}

// From the finest level. Distances below `enough` need not be told apart.
double LevelErrors::bound_of(std::uint32_t vertices, double enough) const {
  if (vertices >= mesh_.vertex_count()) return 0;
  const PlacedLevel level = levels_.placed_level(vertices);
  if (level.triangles.empty()) return HUGE_VAL;
  return distance_bound(BoundedSurface(level.positions, level.triangles, scheduler_), finest_, enough, scheduler_);
}

double LevelErrors::error_of(std::uint32_t vertices) const { return sum_up(bound_of(vertices, 0), mesh_.finest_error); }

// Errors nearly always fall as vertices come in, and the metric's estimate is seldom wrong by more than a factor of
// three: from there in steps that grow, then by halving the interval in proportion.
std::uint32_t LevelErrors::vertices_for(double error) const {
  const double room = error - mesh_.finest_error;
  if (!(room > 0)) return mesh_.vertex_count();
  const double enough = (1 - 1e-6) * room;  // the bound is a little larger than that
  const auto is_near = [&](std::uint32_t vertices) { return bound_of(vertices, enough) <= room; };
  std::uint32_t far = mesh_.base_vertices, near = mesh_.vertex_count();
  if (far >= near || is_near(far)) return far;
  double step = 1.5;
  double next = std::max(levels_.vertices_for_error(static_cast<float>(error)), far + 1);
  while (near - far > 1 && near > 1.01 * far) {
    const std::uint32_t at =
        levels_.vertices_for(static_cast<std::uint32_t>(std::clamp(next, 1.0 + far, static_cast<double>(near) - 1)));
    if (at <= far) break;  // a vertex of several wedges
    const bool found = is_near(at);
    (found ? near : far) = at;
    const bool open = found ? far == mesh_.base_vertices : near == mesh_.vertex_count();
    next = !open ? std::sqrt(static_cast<double>(near) * far) : found ? near / step : far * step;
    step *= step;
  }
  return near;
}

}  // namespace lodestone
