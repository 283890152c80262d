// LDR-FLIP (andersson2020): how different two pictures look when they take each other's place on a screen.
//
// Both are seen through the contrast sensitivity of the eye at a distance; colours are compared by HyAB after Hunt's
// adjustment, edges and points by derivatives of Gaussians of luminance, and the larger the difference of those, the
// more a difference of colour counts. Every filter is a sum of products of two one-dimensional ones here: exact, and
// 300 multiplications a pixel instead of 2,800.
#pragma once

#include "experiments/metrics/pictures/error_map.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct FlipConfig {
  // Pixels of the screen in one degree of the field of view, positive; the published default: 3840 pixels on 0.7 m,
  // seen from 0.7 m. Filters reach 0.14 degrees: 10 pixels here.
  double pixels_per_degree = 67.0206432765;
};

// 0: the same; 1: as different as the published normalisation knows, pure green against pure blue. Black against white
// is 0.967. Colours are sRGB. Throws InputError for pictures of different sizes or pixels_per_degree out of (0, 1000].
// The same bytes for any number of workers. O(pixels x pixels_per_degree), where the pictures differ nearby (by row,
// between the first and the last difference); 28 bytes a pixel.
[[nodiscard]] ErrorMap flip_error(const Image& reference, const Image& test, Scheduler& scheduler,
                                  const FlipConfig& config = {});

}  // namespace lodestone
