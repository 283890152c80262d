#include "experiments/metrics/image_quality.h"

#include <cstdlib>

#include "experiments/metrics/ssim.h"

namespace lodestone {
namespace {

double mean_absolute(const Image& a, const Image& b) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    if (i % 4 != 3) sum += static_cast<std::uint64_t>(std::abs(int{a.rgba[i]} - int{b.rgba[i]}));
  return static_cast<double>(sum) / (255.0 * 0.75 * static_cast<double>(a.rgba.size()));
}

}  // namespace

ImageQuality image_quality(const Image& reference, const Image& test, Scheduler& scheduler,
                           const ImageQualityConfig& config) {
  ImageQuality quality;
  quality.absolute = summarise(absolute_error(reference, test).value, config.threshold);
  quality.mean_absolute = mean_absolute(reference, test);
  quality.psnr = psnr(reference, test);
  if (config.with_ssim) quality.ssim = ssim(reference, test, scheduler);
  if (config.with_flip)
    quality.flip = summarise(flip_error(reference, test, scheduler, config.flip).value, config.threshold);
  return quality;
}

}  // namespace lodestone
