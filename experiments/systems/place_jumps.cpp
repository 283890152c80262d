#include "experiments/systems/place_jumps.h"

#include <algorithm>
#include <cassert>

#include "experiments/metrics/cost/order_statistics.h"

namespace lodestone {

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
  sample.p99 = 100 * quantile(ways, 0.99), sample.p99_pixels = quantile(pixels, 0.99);
  const double step = length(to_double(after.viewpoint) - to_double(before.viewpoint));
  sample.step = 100 * step;
  if (step > 0) sample.per_step = sample.largest / (100 * step);
  return sample;
}

}  // namespace lodestone
