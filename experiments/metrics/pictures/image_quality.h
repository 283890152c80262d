// A picture against another one, by all measures at once.
#pragma once

#include <vector>

#include "experiments/metrics/pictures/error_map.h"
#include "experiments/metrics/pictures/flip.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct ImageQualityConfig {
  double threshold = visible_change;  // of ErrorSummary::share_above, for both maps
  FlipConfig flip{};
  bool with_flip = true, with_ssim = true;
};

struct ImageQuality {
  double mean_absolute = 0;   // over red, green and blue of all pixels, in [0, 1]
  ErrorSummary absolute;      // of absolute_error(): the largest of the three, by pixel
  double psnr = 0;            // decibels; infinite for equal pictures
  double ssim = 1;            // 1 when not asked for
  ErrorSummary flip;          // empty when not asked for
  std::vector<double> added;  // by picture_metric_names()
};

// The measures with the maps that they were taken of; the map of FLIP is empty when not asked for.
struct PictureErrors {
  ErrorMap absolute, flip;
  ImageQuality quality;
};

// Throws what the measures throw.
[[nodiscard]] PictureErrors picture_errors(const Image& reference, const Image& test, Scheduler& scheduler,
                                           const ImageQualityConfig& config = {});
[[nodiscard]] ImageQuality image_quality(const Image& reference, const Image& test, Scheduler& scheduler,
                                         const ImageQualityConfig& config = {});

}  // namespace lodestone
