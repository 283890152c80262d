#include "core/spatial/needle_slabs.h"

#include <limits>

#include "core/math/round_up.h"

namespace lodestone {
namespace {

Vec3d unit_or_zero(Vec3d v) {
  const double whole = length(v);
  return whole > 0 ? (1 / whole) * v : Vec3d{};
}

}  // namespace

NeedleDirections::NeedleDirections(const std::array<Vec3d, 3>& corners) {
  std::array<Vec3d, 3> sides;
  for (std::size_t k = 0; k < 3; ++k) sides[k] = corners[(k + 1) % 3] - corners[k];
  along = unit_or_zero(*std::ranges::max_element(sides, {}, [](Vec3d side) { return dot(side, side); }));
  normal = unit_or_zero(cross(sides[0], sides[1]));
}

void NeedleDirections::add(const NeedleDirections& other) {
  const auto aligned = [](Vec3d sum, Vec3d v) { return dot(sum, v) < 0 ? sum - v : sum + v; };
  along = aligned(along, other.along);
  normal = aligned(normal, other.normal);
}

NeedleSlabs::NeedleSlabs(const NeedleDirections& needles) {
  constexpr double shorter = 1 - 1e-6;
  const Vec3d along = unit_or_zero(needles.along), first = unit_or_zero(cross(needles.normal, along));
  across[0] = to_float(shorter * first);
  across[1] = to_float(shorter * cross(along, first));
  std::ranges::fill(&lo[0][0], &lo[0][0] + 4, std::numeric_limits<float>::infinity());
  std::ranges::fill(&hi[0][0], &hi[0][0] + 4, -std::numeric_limits<float>::infinity());
}

void NeedleSlabs::extend(int child, const std::array<Vec3d, 3>& corners) {
  for (const int k : {0, 1})
    for (const Vec3d p : corners) {
      const double at = dot(to_double(across[k]), p);
      lo[child][k] = std::min(lo[child][k], float_down(at));
      hi[child][k] = std::max(hi[child][k], float_up(at));
    }
}

}  // namespace lodestone
