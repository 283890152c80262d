#include "experiments/systems/place_jumps.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace lodestone {
namespace {

// The smallest way that 99 % of the points do not exceed.
double p99_of(std::vector<double>& ways) {
  if (ways.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(std::ceil(0.99 * static_cast<double>(ways.size()))) - 1;
  std::ranges::nth_element(ways, ways.begin() + at);
  return ways[static_cast<std::size_t>(at)];
}

}  // namespace

JumpSample place_jumps(const PlacedFrame& before, const PlacedFrame& after, const Screen& screen) {
  assert(before.places.size() == after.places.size());
  std::vector<double> ways, pixels;
  JumpSample sample;
  for (std::size_t i = 0; i < after.places.size(); ++i) {
    const Vec3d from = to_double(before.places[i]), to = to_double(after.places[i]);
    ways.push_back(length(to - from));
    sample.largest = std::max(sample.largest, 100 * ways.back());
    const auto seen_to = screen.project(to), seen_from = screen.project(from);
    if (!seen_from || !seen_to || !(seen_from->inside || seen_to->inside)) continue;
    pixels.push_back(distance(*seen_from, *seen_to));
    sample.pixels = std::max(sample.pixels, pixels.back());
  }
  sample.p99 = 100 * p99_of(ways), sample.p99_pixels = p99_of(pixels);
  const double step = length(to_double(after.viewpoint) - to_double(before.viewpoint));
  sample.step = 100 * step;
  if (step > 0) sample.per_step = sample.largest / (100 * step);
  return sample;
}

}  // namespace lodestone
