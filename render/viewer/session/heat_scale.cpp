#include "render/viewer/session/heat_scale.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lodestone::viewer {
namespace {

constexpr Vec3f grey{0.75f, 0.75f, 0.75f};
// From the least to the largest, interpolated linearly.
constexpr std::array<Vec3f, 5> ramp{{{0.15f, 0.25f, 0.75f},
                                     {0.10f, 0.65f, 0.80f},
                                     {0.35f, 0.80f, 0.35f},
                                     {0.95f, 0.80f, 0.20f},
                                     {0.90f, 0.20f, 0.15f}}};

}  // namespace

void HeatRange::extend(double figure) {
  if (!(figure > 0)) return;
  least = most > 0 ? std::min(least, figure) : figure;
  most = std::max(most, figure);
}

int heat_step(double figure, const HeatRange& range) {
  if (!(figure > 0) || !(range.most > 0)) return 0;
  if (!(range.most > range.least)) return 1;
  const double share = std::log(figure / range.least) / std::log(range.most / range.least);
  return 1 + std::clamp(static_cast<int>(share * heat_steps), 0, heat_steps - 1);
}

double heat_of_step(int step, const HeatRange& range) {
  return range.least * std::pow(range.most / range.least, (step - 0.5) / heat_steps);
}

Vec3f heat_colour(int step) {
  if (step < 1) return grey;
  const float at = static_cast<float>(step - 1) / (heat_steps - 1) * static_cast<float>(ramp.size() - 1);
  const std::size_t lower = std::min(static_cast<std::size_t>(at), ramp.size() - 2);
  const float share = at - static_cast<float>(lower);
  return (1 - share) * ramp[lower] + share * ramp[lower + 1];
}

}  // namespace lodestone::viewer
