// Difference of two pictures, pixel by pixel, and figures that sum up such a map.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/frame/image.h"

namespace lodestone {

// One value per pixel, rows from the top, each in [0, 1].
struct ErrorMap {
  ImageSize size;
  std::vector<float> value;
};

// Default threshold of a visible change: the same as in difference().
inline constexpr double visible_change = 8.0 / 255;

struct ErrorSummary {
  double mean = 0, p50 = 0, p99 = 0, max = 0;
  double share_above = 0;    // share of the pixels above the threshold
  std::uint64_t pixels = 0;  // looked at; all figures are 0 when there are none
};

// p50 and p99: the smallest value that such a share of the pixels does not exceed.
[[nodiscard]] ErrorSummary summarise(std::span<const float> values, double threshold = visible_change);

// The largest difference of red, green or blue, over 255. Throws InputError when the sizes differ or a picture is
// empty, as everything does that compares two pictures.
[[nodiscard]] ErrorMap absolute_error(const Image& a, const Image& b);

// Mean square error of red, green and blue in decibels below full scale; infinite for equal pictures.
[[nodiscard]] double psnr(const Image& a, const Image& b);

// The largest that is finite: of two pictures of so many pixels, one of them at least, that differ by the least step of
// one colour of one pixel.
[[nodiscard]] double largest_psnr(std::uint64_t pixels);

// Throws InputError, as said above.
void check_comparable(const Image& a, const Image& b);

}  // namespace lodestone
