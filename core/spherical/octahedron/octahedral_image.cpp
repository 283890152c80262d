#include "core/spherical/octahedron/octahedral_image.h"

#include <cmath>
#include <utility>

#include "core/base/error.h"

namespace lodestone::spherical {
namespace {

void require_square(PixelSize size) {
  if (size.width == size.height && size.width > 0) return;
  throw InputError(describe("", "octahedral image",
                            "is " + std::to_string(size.width) + " x " + std::to_string(size.height) + " texels",
                            "give one with equal sides"));
}

}  // namespace

std::array<float, 4> sample(const LinearImage& image, SquarePoint p) {
  const std::int64_t n = image.size.width;
  const double x = p.s * static_cast<double>(n) - 0.5, y = p.t * static_cast<double>(n) - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const auto along = static_cast<float>(x - left), down = static_cast<float>(y - top);
  const std::array<float, 2> across_weight{1 - along, along}, down_weight{1 - down, down};
  std::array<float, 4> sum{};
  for (std::int64_t j = 0; j < 2; ++j)
    for (std::int64_t i = 0; i < 2; ++i) {
      const Texel at = continued({static_cast<std::int64_t>(left) + i, static_cast<std::int64_t>(top) + j}, n);
      const float weight = across_weight[static_cast<std::size_t>(i)] * down_weight[static_cast<std::size_t>(j)];
      const auto texel = static_cast<std::size_t>(at.y * n + at.x) * image.channels;
      for (std::size_t c = 0; c < image.channels; ++c) sum[c] += weight * image.values[texel + c];
    }
  return sum;
}

void average_border(LinearImage& image) {
  require_square(image.size);
  const std::size_t n = image.size.width, last = n - 1, channels = image.channels;
  if (n == 1) return;
  const auto value = [&](std::size_t x, std::size_t y, std::size_t c) -> float& {
    return image.values[(y * n + x) * channels + c];
  };
  const auto average = [](float& a, float& b) { a = b = 0.5f * (a + b); };
  for (std::size_t c = 0; c < channels; ++c) {
    const float corner = 0.25f * ((value(0, 0, c) + value(last, last, c)) + (value(last, 0, c) + value(0, last, c)));
    for (const std::size_t side : {std::size_t{0}, last})
      for (std::size_t i = 1; 2 * i < last; ++i) {
        average(value(i, side, c), value(last - i, side, c));
        average(value(side, i, c), value(side, last - i, c));
      }
    for (const std::size_t x : {std::size_t{0}, last})
      for (const std::size_t y : {std::size_t{0}, last}) value(x, y, c) = corner;
  }
}

std::vector<PixelImage> symmetric_levels(LinearImage image, PixelMeaning meaning) {
  std::vector<PixelImage> levels;
  for (;;) {
    average_border(image);
    levels.push_back(to_pixels(image, meaning));
    if (image.size == PixelSize{1, 1}) return levels;
    image = halve(image);
  }
}

}  // namespace lodestone::spherical
