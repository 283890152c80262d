#include "core/texture/downsample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/io/colour.h"

namespace lodestone {
namespace {

bool has_alpha(std::uint32_t channels) { return channels == 4; }

// The light at which rounding goes from one byte to the next: exact, and no power function per pixel.
const std::array<float, 255>& srgb_thresholds() {
  static const std::array<float, 255> table = [] {
    std::array<float, 255> thresholds{};
    for (std::size_t i = 0; i < thresholds.size(); ++i)
      thresholds[i] = static_cast<float>(srgb_to_linear((static_cast<double>(i) + 0.5) / 255));
    return thresholds;
  }();
  return table;
}

std::uint8_t srgb_byte(float light) {
  const std::array<float, 255>& table = srgb_thresholds();
  return static_cast<std::uint8_t>(std::upper_bound(table.begin(), table.end(), light) - table.begin());
}

std::uint8_t byte_of(float unit) { return static_cast<std::uint8_t>(std::clamp(unit, 0.0f, 1.0f) * 255 + 0.5f); }

void colour_to_pixel(std::span<const float> from, std::span<std::uint8_t> to) {
  const float alpha = has_alpha(static_cast<std::uint32_t>(from.size())) ? from[3] : 1;
  const float scale = alpha > 0 ? 1 / alpha : 0;
  for (std::size_t c = 0; c < std::min<std::size_t>(from.size(), 3); ++c) to[c] = srgb_byte(from[c] * scale);
  if (from.size() == 4) to[3] = byte_of(alpha);
}

void normal_to_pixel(std::span<const float> from, std::span<std::uint8_t> to) {
  float square = 0;
  for (std::size_t c = 0; c < std::min<std::size_t>(from.size(), 3); ++c) square += from[c] * from[c];
  const float scale = square > 0 && from.size() >= 3 ? 1 / std::sqrt(square) : 1;
  for (std::size_t c = 0; c < from.size(); ++c) to[c] = byte_of(0.5f + 0.5f * from[c] * (c < 3 ? scale : 1));
}

// The weights by which pixel i of n / 2 takes pixels 2i, 2i + 1, 2i + 2 of n.
std::array<float, 3> shares(std::uint32_t i, std::uint32_t n) {
  if (n == 1) return {1, 0, 0};
  if (n % 2 == 0) return {0.5f, 0.5f, 0};
  const auto whole = static_cast<float>(n), half = static_cast<float>(n / 2), at = static_cast<float>(i);
  return {(half - at) / whole, half / whole, (at + 1) / whole};
}

// One row at half its width.
void halve_row(std::span<const float> from, std::span<float> to, std::uint32_t width, std::uint32_t channels) {
  const std::size_t pixels = to.size() / channels;
  for (std::uint32_t x = 0; x < pixels; ++x) {
    const std::array<float, 3> share = shares(x, width);
    for (std::uint32_t c = 0; c < channels; ++c) {
      float sum = 0;
      for (std::size_t k = 0; k < 3; ++k)
        if (share[k] > 0) sum += share[k] * from[(2 * x + k) * channels + c];
      to[x * channels + c] = sum;
    }
  }
}

}  // namespace

LinearImage to_linear(const PixelImage& image, PixelMeaning meaning) {
  LinearImage linear{image.size, image.channels, std::vector<float>(image.pixels.size())};
  const std::array<float, 256>& light = linear_of_srgb();
  for (std::size_t p = 0; p < image.pixels.size(); p += image.channels) {
    const float alpha = has_alpha(image.channels) ? static_cast<float>(image.pixels[p + 3]) / 255 : 1;
    for (std::size_t c = 0; c < image.channels; ++c) {
      const std::uint8_t byte = image.pixels[p + c];
      float& value = linear.values[p + c];
      if (meaning == PixelMeaning::normals) {
        value = static_cast<float>(byte) / 127.5f - 1;
      } else {
        value = c == 3 ? alpha : light[byte] * alpha;
      }
    }
  }
  return linear;
}

PixelImage to_pixels(const LinearImage& image, PixelMeaning meaning) {
  PixelImage out{.size = image.size, .channels = image.channels, .pixels = {}};
  out.pixels.resize(image.values.size());
  const auto convert = meaning == PixelMeaning::normals ? normal_to_pixel : colour_to_pixel;
  for (std::size_t p = 0; p < out.pixels.size(); p += image.channels)
    convert(std::span(image.values).subspan(p, image.channels), std::span(out.pixels).subspan(p, image.channels));
  return out;
}

LinearImage halve(const LinearImage& image) {
  const PixelSize size = half_of(image.size);
  const std::size_t row = std::size_t{size.width} * image.channels;
  const std::size_t full_row = std::size_t{image.size.width} * image.channels;
  LinearImage out{size, image.channels, std::vector<float>(row * size.height)};
  std::vector<float> narrow(row);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    const std::array<float, 3> share = shares(y, image.size.height);
    const std::span<float> to = std::span(out.values).subspan(y * row, row);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(share[k] > 0)) continue;
      halve_row(std::span(image.values).subspan((2 * y + k) * full_row, full_row), narrow, image.size.width,
                image.channels);
      for (std::size_t i = 0; i < row; ++i) to[i] += share[k] * narrow[i];
    }
  }
  return out;
}

}  // namespace lodestone
