#include "core/texture/downsample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/texture/colour.h"

namespace lodestone {
namespace {

bool has_alpha(std::uint32_t channels) { return channels == 4; }

// The light at which rounding changes from one byte to the next: exact, and without a power function per pixel.
const std::array<float, 255>& srgb_thresholds() {
  static const std::array<float, 255> table = [] {
    std::array<float, 255> thresholds{};
    for (std::size_t i = 0; i < thresholds.size(); ++i)
      thresholds[i] = static_cast<float>(srgb_to_linear((static_cast<double>(i) + 0.5) / 255));
    return thresholds;
  }();
  return table;
}

// The byte of a light: the number of thresholds that do not exceed it, counted from a near one.
class SrgbBytes {
 public:
  SrgbBytes() : thresholds_(srgb_thresholds()) {
    for (std::size_t i = 0; i < near_.size(); ++i)
      near_[i] = static_cast<std::uint8_t>(std::ranges::upper_bound(thresholds_, static_cast<float>(i) / steps) -
                                           thresholds_.begin());
  }
  [[nodiscard]] std::uint8_t operator()(float light) const {
    if (!(light > 0)) return 0;
    std::size_t byte = near_[light < 1 ? static_cast<std::size_t>(light * steps) : near_.size() - 1];
    while (byte < thresholds_.size() && thresholds_[byte] <= light) ++byte;
    return static_cast<std::uint8_t>(byte);
  }

 private:
  static constexpr float steps = 4096;
  const std::array<float, 255>& thresholds_;
  std::array<std::uint8_t, static_cast<std::size_t>(steps) + 1> near_{};
};

std::uint8_t byte_of(float unit) { return static_cast<std::uint8_t>(std::clamp(unit, 0.0f, 1.0f) * 255 + 0.5f); }

void colour_to_pixel(const SrgbBytes& srgb_byte, std::span<const float> from, std::span<std::uint8_t> to) {
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

// The weights of pixels 2i, 2i + 1, 2i + 2 of n in pixel i of n / 2.
std::array<float, 3> shares(std::uint32_t i, std::uint32_t n) {
  if (n == 1) return {1, 0, 0};
  if (n % 2 == 0) return {0.5f, 0.5f, 0};
  const auto whole = static_cast<float>(n), half = static_cast<float>(n / 2), at = static_cast<float>(i);
  return {(half - at) / whole, half / whole, (at + 1) / whole};
}

// For an even width.
template <std::size_t Channels>
void halve_even_row(std::span<const float> from, std::span<float> to) {
  for (std::size_t x = 0; x < to.size(); x += Channels)
    for (std::size_t c = 0; c < Channels; ++c) to[x + c] = 0.5f * from[2 * x + c] + 0.5f * from[2 * x + Channels + c];
}

// Reduces one row to half its width.
void halve_row(std::span<const float> from, std::span<float> to, std::uint32_t width, std::uint32_t channels) {
  if (width % 2 == 0 && channels == 3) return halve_even_row<3>(from, to);
  if (width % 2 == 0 && channels == 4) return halve_even_row<4>(from, to);
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

// Converts the bytes of any number of pixels to numbers.
void to_linear(std::span<const std::uint8_t> pixels, std::uint32_t channels, PixelMeaning meaning,
               std::span<float> values) {
  const std::array<float, 256>& light = linear_of_srgb();
  for (std::size_t p = 0; p < pixels.size(); p += channels) {
    const float alpha = has_alpha(channels) ? static_cast<float>(pixels[p + 3]) / 255 : 1;
    for (std::size_t c = 0; c < channels; ++c) {
      const std::uint8_t byte = pixels[p + c];
      float& value = values[p + c];
      if (meaning == PixelMeaning::normals) {
        value = static_cast<float>(byte) / 127.5f - 1;
      } else if (meaning == PixelMeaning::values) {
        value = static_cast<float>(byte) / 255;
      } else {
        value = c == 3 ? alpha : light[byte] * alpha;
      }
    }
  }
}

// row_of(y) returns a row of the image.
template <class RowOf>
LinearImage halve_rows(PixelSize full, std::uint32_t channels, const RowOf& row_of) {
  const PixelSize size = half_of(full);
  const std::size_t row = std::size_t{size.width} * channels;
  LinearImage out{size, channels, std::vector<float>(row * size.height)};
  std::vector<float> narrow(row);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    const std::array<float, 3> share = shares(y, full.height);
    const std::span<float> to = std::span(out.values).subspan(y * row, row);
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (!(share[k] > 0)) continue;
      halve_row(row_of(2 * y + k), narrow, full.width, channels);
      for (std::size_t i = 0; i < row; ++i) to[i] += share[k] * narrow[i];
    }
  }
  return out;
}

}  // namespace

LinearImage to_linear(const PixelImage& image, PixelMeaning meaning) {
  LinearImage linear{image.size, image.channels, std::vector<float>(image.pixels.size())};
  to_linear(image.pixels, image.channels, meaning, linear.values);
  return linear;
}

PixelImage to_pixels(const LinearImage& image, PixelMeaning meaning) {
  PixelImage out{.size = image.size, .channels = image.channels, .pixels = {}};
  out.pixels.resize(image.values.size());
  static const SrgbBytes srgb_byte;
  for (std::size_t p = 0; p < out.pixels.size(); p += image.channels) {
    const std::span<const float> from = std::span(image.values).subspan(p, image.channels);
    const std::span<std::uint8_t> to = std::span(out.pixels).subspan(p, image.channels);
    switch (meaning) {
      case PixelMeaning::colours:
        colour_to_pixel(srgb_byte, from, to);
        break;
      case PixelMeaning::normals:
        normal_to_pixel(from, to);
        break;
      case PixelMeaning::values:
        std::transform(from.begin(), from.end(), to.begin(), byte_of);
        break;
    }
  }
  return out;
}

LinearImage halve(const LinearImage& image) {
  const std::size_t row = std::size_t{image.size.width} * image.channels;
  return halve_rows(image.size, image.channels,
                    [&](std::uint32_t y) { return std::span(image.values).subspan(y * row, row); });
}

LinearImage halve(const PixelImage& image, PixelMeaning meaning) {
  std::vector<float> values(std::size_t{image.size.width} * image.channels);
  return halve_rows(image.size, image.channels, [&](std::uint32_t y) -> std::span<const float> {
    to_linear(std::span(image.pixels).subspan(y * values.size(), values.size()), image.channels, meaning, values);
    return values;
  });
}

}  // namespace lodestone
