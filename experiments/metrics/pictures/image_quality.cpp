#include "experiments/metrics/pictures/image_quality.h"

#include <cstdlib>

#include "experiments/metrics/pictures/picture_metric.h"
#include "experiments/metrics/pictures/ssim.h"

namespace lodestone {
namespace {

double mean_absolute(const Image& a, const Image& b) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    if (i % 4 != 3) sum += static_cast<std::uint64_t>(std::abs(int{a.rgba[i]} - int{b.rgba[i]}));
  return static_cast<double>(sum) / (255.0 * 0.75 * static_cast<double>(a.rgba.size()));
}

}  // namespace

PictureErrors picture_errors(const Image& reference, const Image& test, Scheduler& scheduler,
                             const ImageQualityConfig& config) {
  PictureErrors errors;
  errors.absolute = absolute_error(reference, test);
  errors.quality.absolute = summarise(errors.absolute.value, config.threshold);
  errors.quality.mean_absolute = mean_absolute(reference, test);
  errors.quality.psnr = psnr(reference, test);
  if (config.with_ssim) errors.quality.ssim = ssim(reference, test, scheduler);
  for (const std::string& name : picture_metric_names())
    errors.quality.added.push_back(picture_metric(name).measure(reference, test));
  if (!config.with_flip) return errors;
  errors.flip = flip_error(reference, test, scheduler, config.flip);
  errors.quality.flip = summarise(errors.flip.value, config.threshold);
  return errors;
}

ImageQuality image_quality(const Image& reference, const Image& test, Scheduler& scheduler,
                           const ImageQualityConfig& config) {
  return picture_errors(reference, test, scheduler, config).quality;
}

}  // namespace lodestone
