// Measures of pictures of a user's own, beside ours.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/frame/image.h"

namespace lodestone {

struct PictureMetric {
  std::string unit = {};        // "%", "dB", ...; empty: none
  std::string meaning = {};     // half a sentence, for lists and reports
  bool more_is_better = false;  // as for PSNR
  // A finite number, the same for equal pictures, from one thread at a time. Reference: the full model's picture. Both
  // have the same size.
  std::function<double(const Image& reference, const Image& test)> measure = {};
};

// Every experiment that compares pictures has its mean as column metric_NAME, and the worst picture's value as
// metric_NAME_worst, from then on. Throws InputError for a name that is taken or cannot be one (core/base/registry.h),
// and for a metric without measure. To be called before any is used.
void add_picture_metric(const std::string& name, PictureMetric metric);

[[nodiscard]] std::vector<std::string> picture_metric_names();  // of what was added, in that order
[[nodiscard]] const PictureMetric& picture_metric(const std::string& name);

}  // namespace lodestone
