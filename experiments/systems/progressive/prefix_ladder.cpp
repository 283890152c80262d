#include "experiments/systems/progressive/prefix_ladder.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "experiments/systems/surface/surface_distance.h"
#include "parallel/progressive/make_progressive.h"

namespace lodestone {
namespace {

constexpr double step_ratio = std::numbers::sqrt2;
constexpr double least_rise = 1.2;  // of the error from step to step: vertices would move at once with less
constexpr std::size_t fewest_triangles = 100;

ProgressiveMesh progressive_of(const WeldedSurface& surface, const Transform& transform, Scheduler& scheduler) {
  ProgressiveReport report;
  return make_progressive(indexed_mesh(surface, transform), {}, scheduler, report);
}

// From the finest to the coarsest: numbers of vertices.
std::vector<std::uint32_t> prefixes(const ProgressiveMesh& mesh, const LevelFinder& levels) {
  std::vector<std::uint32_t> counts{mesh.vertex_count()};
  auto triangles = static_cast<double>(mesh.triangles.size());
  while (triangles > fewest_triangles && counts.back() > mesh.base_vertices) {
    triangles /= step_ratio;
    const std::uint32_t count = levels.vertices_for_triangles(static_cast<std::size_t>(triangles));
    if (count < counts.back() && levels.triangles_of(count) > 0) counts.push_back(count);
  }
  return counts;
}

}  // namespace

PrefixLadder::PrefixLadder(const WeldedSurface& surface, const Transform& transform, Scheduler& scheduler)
    : mesh_(progressive_of(surface, transform, scheduler)),
      levels_(mesh_),
      normals_(lodestone::normals_at(surface, mesh_.positions)) {
  const TriangleBvh full = tree_of({mesh_.positions, mesh_.triangles});
  for (const std::uint32_t count : prefixes(mesh_, levels_)) {
    PlacedLevel level = levels_.placed_level(count);
    LadderStep step;
    for (const std::uint32_t t : coherent_order(level.positions, level.triangles))
      step.triangles.push_back(level.triangles[t]);
    if (!steps_.empty())
      step.error = std::max(steps_.back().error,
                            surface_distance({level.positions, step.triangles}, surface.positions, full, scheduler));
    step.positions = std::move(level.positions);
    if (steps_.size() > 1 && step.error < least_rise * steps_.back().error) steps_.pop_back();
    steps_.push_back(std::move(step));
  }
  for (std::size_t i = 0; i + 1 < steps_.size(); ++i)
    steps_[i].ancestor = levels_.compute_geomorph(static_cast<std::uint32_t>(steps_[i + 1].positions.size()),
                                                  static_cast<std::uint32_t>(steps_[i].positions.size()));
}

PrefixLadder::Place PrefixLadder::place_for(double error) const {
  const auto coarser = std::ranges::find_if(steps_, [&](const LadderStep& step) { return step.error > error; });
  if (coarser == steps_.begin()) return {};
  Place place{static_cast<std::size_t>(coarser - steps_.begin()) - 1, 0};
  if (coarser == steps_.end()) return place;
  const double own = steps_[place.step].error;
  place.share = (error - own) / (coarser->error - own);
  return place;
}

std::vector<Vec3f> PrefixLadder::positions_at(const Place& place) const {
  const LadderStep& step = steps_[place.step];
  std::vector<Vec3f> positions = step.positions;
  if (place.share == 0) return positions;
  const auto share = static_cast<float>(place.share);
  for (std::size_t v = 0; v < positions.size(); ++v)
    positions[v] = (1 - share) * positions[v] + share * steps_[place.step + 1].positions[step.ancestor[v]];
  return positions;
}

std::vector<PackedNormal> PrefixLadder::normals_at(const Place& place) const {
  const LadderStep& step = steps_[place.step];
  std::vector<PackedNormal> normals(normals_.begin(),
                                    normals_.begin() + static_cast<std::ptrdiff_t>(step.positions.size()));
  if (place.share == 0) return normals;
  const auto share = static_cast<float>(place.share);
  for (std::size_t v = 0; v < normals.size(); ++v)
    if (step.ancestor[v] != v)
      normals[v] =
          pack_normal((1 - share) * unpack_normal(normals_[v]) + share * unpack_normal(normals_[step.ancestor[v]]));
  return normals;
}

std::vector<std::uint32_t> PrefixLadder::vertex_of_points(std::size_t step) const {
  return levels_.compute_geomorph(static_cast<std::uint32_t>(steps_[step].positions.size()), mesh_.vertex_count());
}

}  // namespace lodestone
