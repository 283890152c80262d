#include "parallel/spherical/map_to_sphere.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/error.h"
#include "parallel/spherical/sphere_levels.h"
#include "parallel/spherical/surface_collapse.h"

namespace lodestone {
namespace {

constexpr std::size_t area_grain = 8192;
constexpr double sphere_area = 4 * std::numbers::pi;

struct Effort {
  std::string_view name;
  double growth;  // of levels
  int sweeps;     // at each
};
constexpr std::array<Effort, 3> efforts{{{"fast", 2, 8}, {"normal", 1.3, 12}, {"best", 1.3, 40}}};

// The last attempt knows the connectivity alone: all triangles are alike.
struct Attempt {
  CollapseBy collapse_by = CollapseBy::shape;
  double surface = 1;     // factor on the surface
  double least_area = 0;  // as SphereLevelsConfig
  int ring_sweeps = 0;    // likewise
};
constexpr std::array<Attempt, 3> attempts{
    {{CollapseBy::shape, 1, 1e-4, 0}, {CollapseBy::shape, 1, 1e-1, 4}, {CollapseBy::connectivity, 0, 1, 4}}};

// Around the origin and of area 4 pi; of extent 1 if it has no area.
std::vector<Vec3d> scaled_surface(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  if (positions.empty()) return {};
  Vec3d low = positions[0], high = positions[0];
  for (const Vec3d p : positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3d centre = 0.5 * low + 0.5 * high, half = 0.5 * high - 0.5 * low;
  const double extent = std::max({half.x, half.y, half.z, 1e-300});
  std::vector<Vec3d> surface(positions.size());
  for (std::size_t v = 0; v < surface.size(); ++v) surface[v] = (1 / extent) * (positions[v] - centre);
  double area = 0;
  for (const Triangle& t : triangles)
    area += length(cross(surface[t.v[1]] - surface[t.v[0]], surface[t.v[2]] - surface[t.v[0]])) / 2;
  const double scale = area > 0 ? std::sqrt(sphere_area / area) : 1;
  for (Vec3d& p : surface) p = scale * p;
  return surface;
}

spherical::SphereSums measure(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                              std::span<const Vec3d> directions, Scheduler& scheduler) {
  std::vector<spherical::SphereSums> parts(chunk_count(triangles.size(), area_grain));
  scheduler.for_chunks(triangles.size(), area_grain, [&](ChunkRange c) {
    parts[c.index] = spherical::measure_sphere_map(positions, triangles.subspan(c.begin, c.end - c.begin), directions);
  });
  spherical::SphereSums sums;
  for (const spherical::SphereSums& part : parts) sums.add(part);
  return sums;
}

}  // namespace

SphereEffort sphere_effort(std::string_view name) {
  std::string known;
  for (std::size_t k = 0; k < efforts.size(); ++k) {
    if (efforts[k].name == name) return static_cast<SphereEffort>(k);
    known += (k == 0 ? "" : ", ") + std::string(efforts[k].name);
  }
  throw InputError(describe({}, {}, "unknown effort '" + std::string(name) + "'", "use one of " + known));
}

std::vector<Vec3d> map_to_sphere(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                                 const SphereMapConfig& config, Scheduler& scheduler, SphereMapReport& report) {
  const Effort& effort = efforts[static_cast<std::size_t>(config.effort)];
  std::vector<Vec3d> directions(positions.size());
  report = {};
  std::vector<Vec3d> surface;
  for (const Attempt& attempt : attempts) {
    ++report.attempts;
    const CpuClock collapse_clock;
    SurfaceCollapse collapse(positions, triangles, attempt.collapse_by, config.instructions, scheduler);
    report.collapse = collapse_clock.elapsed();
    report.by_connectivity = collapse.by_connectivity();
    const CpuClock map_clock;
    const spherical::SplitSchedule schedule =
        spherical::make_split_schedule(collapse.rings(), collapse.collapses(), effort.growth);
    if (surface.empty()) surface = scaled_surface(positions, triangles);
    std::vector<AlignedPoint4d> numbered(surface.size());
    for (std::size_t v = 0; v < surface.size(); ++v) numbered[v] = attempt.surface * surface[collapse.sources()[v]];
    SphereLevels levels(collapse.rings(), numbered,
                        {.sweeps = effort.sweeps,
                         .guard = config.guard,
                         .least_area = attempt.least_area,
                         .ring_sweeps = attempt.ring_sweeps,
                         .instructions = config.instructions},
                        scheduler);
    if (!levels.run(schedule, collapse.base())) continue;
    for (std::size_t v = 0; v < directions.size(); ++v)
      directions[collapse.sources()[v]] = levels.directions()[v].point();
    report.map = map_clock.elapsed();
    report.levels = schedule.levels.size() - 1;
    report.waves = schedule.waves.size() - 1;
    report.colours = levels.colours();
    const CpuClock measure_clock;
    report.sums = measure(surface, triangles, directions, scheduler);
    report.measure = measure_clock.elapsed();
    return directions;
  }
  throw InputError(describe({}, "map to the sphere", "a vertex found no place between its neighbours",
                            "simplify the surface first"));
}

}  // namespace lodestone
