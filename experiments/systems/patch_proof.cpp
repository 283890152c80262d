#include "experiments/systems/patch_proof.h"

#include <algorithm>
#include <tuple>

#include "experiments/metrics/cracks/leaks.h"
#include "experiments/metrics/cracks/t_junctions.h"
#include "experiments/metrics/drawn/border.h"

namespace lodestone {
namespace {

bool comes_before(Vec3d a, Vec3d b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

bool is_in(const std::vector<Vec3d>& ascending, Vec3d p) {
  return std::ranges::binary_search(ascending, p, comes_before);
}

}  // namespace

PatchProof::PatchProof(const DrawnMesh& full, double junction_distance, Scheduler& scheduler)
    : junction_distance_(junction_distance), scheduler_(scheduler) {
  for (const BorderEdge& edge : border_edges(full.positions, full.triangles))
    for (const std::uint32_t v : edge.vertex) border_.push_back(full.positions[v]);
  std::ranges::sort(border_, comes_before);
}

SurfaceSample PatchProof::measure(const DrawnPatches& drawn, const Screen& screen,
                                  std::optional<std::span<const float>> full_depth) const {
  const auto& [positions, triangles] = drawn.surface;
  std::vector<Vec3d> moved;  // of the border
  for (std::size_t i = 0; i < drawn.points.places.size(); ++i)
    if (is_in(border_, to_double(drawn.points.points[i]))) moved.push_back(to_double(drawn.points.places[i]));
  std::ranges::sort(moved, comes_before);
  const auto expected = [&](std::uint32_t v) { return is_in(border_, positions[v]) || is_in(moved, positions[v]); };

  SurfaceSample sample;
  sample.triangles = triangles.size() + drawn.skirts.triangles.size();
  for (const BorderEdge& edge : border_edges(positions, triangles))
    if (!expected(edge.vertex[0]) || !expected(edge.vertex[1])) ++sample.open_edges;
  sample.t_junctions = t_junctions(positions, triangles, junction_distance_, scheduler_).vertices;
  if (!full_depth || !border_.empty()) return sample;
  DrawnMesh all = drawn.surface;
  const auto first = static_cast<std::uint32_t>(positions.size());
  all.positions.insert(all.positions.end(), drawn.skirts.positions.begin(), drawn.skirts.positions.end());
  for (const auto& [v] : drawn.skirts.triangles) all.triangles.push_back({{first + v[0], first + v[1], first + v[2]}});
  const LeakReport leaks = find_leaks(all.positions, all.triangles, screen, scheduler_, {.full_depth = *full_depth});
  sample.torn_pixels = leaks.torn, sample.leak_pixels = leaks.leak_pixels();
  return sample;
}

}  // namespace lodestone
