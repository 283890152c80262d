// How visible it is that a picture changes from one frame to the next, in thresholds of the eye.
//
// The eye follows the surface, so that a change is a step in time of what it rests on. To a grating of rho cycles per
// degree that moves over the retina by v degrees a second its sensitivity is (laird2006, the form by kelly1979)
//   S(rho, v) = c0 c1 c2 (6.1 + 7.3 |log10(c2 v / 3)|^3) v (2 pi c1 rho)^2 exp(-4 pi c1 rho (c2 v + 2) / 45.9)
// with c0 = 0.6329, c1 = 0.8404, c2 = 0.7986, and v at least 0.1, as eyes are never at rest. A change by omega cycles a
// second moves by v = omega / rho. The step of a grating is taken to be filtered without a change of phase:
//   r(t) = integral over omega > 0 of S(rho, omega / rho) sin(2 pi omega t) / (pi omega),
// and counts by its swing A(rho) = 2 max r, which for an eye that all frequencies reach alike is the contrast of the
// grating over that at which it is just seen. A has its maximum of 118 at 3 cycles per degree, and is 39 at 0.1 and 5
// at 16.
#pragma once

#include <span>
#include <vector>

#include "experiments/metrics/pictures/error_map.h"
#include "experiments/metrics/pictures/flip.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// A(rho), per unit of contrast; that of 0.05 cycles per degree below, 0 above 60. Throws InputError unless rho >= 0.
[[nodiscard]] double step_sensitivity(double cycles_per_degree);

// Luminance less that of the full model, over the mean luminance of the latter's picture, both with the light of the
// room that sRGB assumes on the screen, 1 % of white (iec61966). Of either sign, at most 100. Throws InputError for
// pictures of different sizes.
[[nodiscard]] ErrorMap contrast_error(const Image& full, const Image& test);

// A change of contrast by pixel, rows from the top, in thresholds: the change filtered by A, without its sign; 1 is
// just visible where what surrounds it hides nothing. Beyond the picture nothing changes. Throws InputError for a
// number of values that is not that of the pixels, and for pixels_per_degree out of (0, 1000]. The same bytes for any
// number of workers. O(n log n); 16 bytes for each pixel, those of a margin of a degree included.
[[nodiscard]] std::vector<float> step_visibility(std::span<const float> change, ImageSize size, Scheduler& scheduler,
                                                 double pixels_per_degree = FlipConfig{}.pixels_per_degree);

}  // namespace lodestone
