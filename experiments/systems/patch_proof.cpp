#include "experiments/systems/patch_proof.h"

#include <algorithm>
#include <tuple>

#include "experiments/metrics/cracks/leaks.h"
#include "experiments/metrics/cracks/t_junctions.h"
#include "experiments/metrics/drawn/border.h"
#include "experiments/metrics/drawn/screen.h"

namespace lodestone {
namespace {

bool comes_before(Vec3d a, Vec3d b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

}  // namespace

PatchProof::PatchProof(const DrawnMesh& full, double junction_distance, Scheduler& scheduler)
    : junction_distance_(junction_distance), scheduler_(scheduler) {
  for (const BorderEdge& edge : border_edges(full.positions, full.triangles))
    for (const std::uint32_t v : edge.vertex) border_.push_back(full.positions[v]);
  std::ranges::sort(border_, comes_before);
}

SurfaceSample PatchProof::measure(const DrawnMesh& drawn, const Screen& screen,
                                  std::optional<std::span<const float>> full_depth) const {
  SurfaceSample sample;
  sample.triangles = drawn.triangles.size();
  const auto expected = [&](std::uint32_t v) {
    return std::ranges::binary_search(border_, drawn.positions[v], comes_before);
  };
  for (const BorderEdge& edge : border_edges(drawn.positions, drawn.triangles))
    if (!expected(edge.vertex[0]) || !expected(edge.vertex[1])) ++sample.open_edges;
  sample.t_junctions = t_junctions(drawn.positions, drawn.triangles, junction_distance_, scheduler_).vertices;
  if (full_depth && border_.empty()) {
    const LeakReport leaks =
        find_leaks(drawn.positions, drawn.triangles, screen, scheduler_, {.full_depth = *full_depth});
    sample.torn_pixels = leaks.torn, sample.leak_pixels = leaks.leak_pixels();
  }
  return sample;
}

}  // namespace lodestone
