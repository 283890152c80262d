#include "experiments/metrics/pictures/error_map.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/base/error.h"
#include "experiments/metrics/cost/order_statistics.h"

namespace lodestone {
namespace {

constexpr std::size_t channels = 4, colours = 3;

// PSNR where the squares of all differences add up to this.
double decibels(double pixels, double squares) { return 10 * std::log10(255.0 * 255.0 * colours * pixels / squares); }

}  // namespace

void check_comparable(const Image& a, const Image& b) {
  for (const Image* image : {&a, &b}) {
    const std::size_t pixels =
        static_cast<std::size_t>(image->size.width) * static_cast<std::size_t>(image->size.height);
    if (image->size.width < 1 || image->size.height < 1 || image->rgba.size() != channels * pixels)
      throw InputError("a picture without pixels cannot be compared");
  }
  if (a.size != b.size) throw InputError("images of different sizes cannot be compared");
}

ErrorSummary summarise(std::span<const float> values, double threshold) {
  ErrorSummary summary;
  summary.pixels = values.size();
  if (values.empty()) return summary;
  const auto count = static_cast<double>(values.size());
  double sum = 0;
  std::uint64_t above = 0;
  for (const float v : values) {
    sum += v;
    above += v > threshold ? 1 : 0;
  }
  summary.mean = sum / count;
  summary.share_above = static_cast<double>(above) / count;
  std::vector<float> sorted(values.begin(), values.end());
  summary.p50 = quantile(sorted, 0.5);
  summary.p99 = quantile(sorted, 0.99);
  summary.max = *std::max_element(sorted.begin(), sorted.end());
  return summary;
}

ErrorMap absolute_error(const Image& a, const Image& b) {
  check_comparable(a, b);
  ErrorMap map{a.size, std::vector<float>(a.rgba.size() / channels)};
  for (std::size_t i = 0; i < map.value.size(); ++i) {
    int worst = 0;
    for (std::size_t c = channels * i; c < channels * i + colours; ++c)
      worst = std::max(worst, std::abs(int{a.rgba[c]} - int{b.rgba[c]}));
    map.value[i] = static_cast<float>(worst) / 255;
  }
  return map;
}

double largest_psnr(std::uint64_t pixels) { return decibels(static_cast<double>(pixels), 1); }

double psnr(const Image& a, const Image& b) {
  check_comparable(a, b);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    if (i % channels == colours) continue;  // alpha
    const int d = int{a.rgba[i]} - int{b.rgba[i]};
    sum += static_cast<std::uint64_t>(d * d);
  }
  if (sum == 0) return std::numeric_limits<double>::infinity();
  return decibels(static_cast<double>(a.rgba.size() / channels), static_cast<double>(sum));
}

}  // namespace lodestone
