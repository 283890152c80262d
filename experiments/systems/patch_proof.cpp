#include "experiments/systems/patch_proof.h"

#include <algorithm>

#include "core/mesh/edge_pairing.h"
#include "experiments/metrics/cracks/leaks.h"
#include "experiments/metrics/cracks/t_junctions.h"
#include "experiments/metrics/drawn/border.h"
#include "experiments/metrics/drawn/screen.h"

namespace lodestone {
namespace {

bool is_in(const std::vector<Vec3d>& ascending, Vec3d p) {
  return std::ranges::binary_search(ascending, p, is_lower<Vec3d>);
}

}  // namespace

PatchProof::PatchProof(const DrawnMesh& full, double junction_distance, Scheduler& scheduler)
    : junction_distance_(junction_distance), scheduler_(scheduler) {
  for (const BorderEdge& edge : border_edges(full.positions, full.triangles))
    for (const std::uint32_t v : edge.vertex) border_.push_back(full.positions[v]);
  std::ranges::sort(border_, is_lower<Vec3d>);
}

SurfaceSample PatchProof::measure(const DrawnPatches& drawn, const Screen& screen,
                                  std::optional<std::span<const float>> full_depth) const {
  const std::vector<Vec3d>& positions = drawn.surface.positions;
  const std::vector<Triangle>& triangles = drawn.surface.triangles;
  std::vector<Vec3d> moved;  // of the border
  for (std::size_t i = 0; i < drawn.points.places.size(); ++i)
    if (is_in(border_, to_double(drawn.points.points[i]))) moved.push_back(to_double(drawn.points.places[i]));
  std::ranges::sort(moved, is_lower<Vec3d>);
  const auto expected = [&](std::uint32_t v) { return is_in(border_, positions[v]) || is_in(moved, positions[v]); };

  SurfaceSample sample;
  sample.triangles = triangles.size() + drawn.skirts.triangles.size();
  for (const BorderEdge& edge : border_edges(positions, triangles))
    if (!expected(edge.vertex[0]) || !expected(edge.vertex[1])) ++sample.open_edges;
  sample.t_junctions = t_junctions(positions, triangles, junction_distance_, scheduler_).vertices;
  if (!full_depth || !border_.empty()) return sample;
  const auto look = [&](const DrawnMesh& mesh) {
    return find_leaks(mesh.positions, mesh.triangles, screen, scheduler_, {.full_depth = *full_depth});
  };
  const LeakReport leaks = look(drawn.surface);
  sample.torn_pixels = leaks.torn, sample.leak_pixels = leaks.leak_pixels();
  if (drawn.skirts.triangles.empty()) return sample;

  // Rays meet skirts that hang in a closed model, too: those that leak with and without them are seen to leak.
  DrawnMesh covered = drawn.surface;
  const auto first = static_cast<std::uint32_t>(positions.size());
  covered.positions.insert(covered.positions.end(), drawn.skirts.positions.begin(), drawn.skirts.positions.end());
  for (const auto& [v] : drawn.skirts.triangles)
    covered.triangles.push_back({{first + v[0], first + v[1], first + v[2]}});
  const LeakReport still = look(covered);
  std::uint64_t both = 0;
  for (std::size_t p = 0; p < leaks.leaks.size(); ++p) both += leaks.leaks[p] & still.leaks[p];
  sample.leak_pixels = both;
  return sample;
}

}  // namespace lodestone
