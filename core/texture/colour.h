// Colours as light, as bytes in the sRGB encoding, and as other numbers that files have.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/mesh/attributes.h"

namespace lodestone {

// [0, 1] to 0..255; values outside go to the nearer end, NaN to 0.
[[nodiscard]] inline std::uint8_t unit_to_byte(double value) {
  return value > 0 ? static_cast<std::uint8_t>(std::lround(255 * std::min(value, 1.0))) : std::uint8_t{0};
}

// Linear light in the sRGB encoding (IEC 61966-2-1).
[[nodiscard]] inline double linear_to_srgb(double value) {
  if (!(value > 0.0031308)) return 12.92 * value;
  return 1.055 * std::pow(value, 1 / 2.4) - 0.055;
}

// The inverse, for all 256 bytes at once and for any value.
[[nodiscard]] inline const std::array<float, 256>& linear_of_srgb() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> linear{};
    for (std::size_t i = 0; i < linear.size(); ++i) {
      const float c = static_cast<float>(i) / 255;
      linear[i] = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
    }
    return linear;
  }();
  return table;
}
[[nodiscard]] inline double srgb_to_linear(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

// Light as 16 bits: converting back gives the same bytes in the sRGB encoding.
using LinearColour = std::array<std::uint16_t, 4>;
[[nodiscard]] inline LinearColour linear_colour(Rgba8 c) {
  const auto wide = [](float light) { return static_cast<std::uint16_t>(light * 65535 + 0.5f); };
  const std::array<float, 256>& linear = linear_of_srgb();
  return {wide(linear[c.r]), wide(linear[c.g]), wide(linear[c.b]), static_cast<std::uint16_t>(c.a * 257)};
}
// The inverse, from light in [0, 1].
[[nodiscard]] inline Rgba8 colour_of_linear(double r, double g, double b, double a) {
  return {unit_to_byte(linear_to_srgb(r)), unit_to_byte(linear_to_srgb(g)), unit_to_byte(linear_to_srgb(b)),
          unit_to_byte(a)};
}

}  // namespace lodestone
