// The colours of FLIP (andersson2020): from sRGB to an opponent space for filtering, from there to CIELAB with Hunt's
// adjustment for comparing.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace lodestone::flip {

using Colour = std::array<float, 3>;

// IEC 61966-2-1: sRGB to CIE XYZ, derived from its primaries and white; its inverse; white, the sums of its
// rows.
inline constexpr double xyz_of_rgb[3][3] = {
    {0.41238656, 0.35759149, 0.18045049}, {0.21263682, 0.71518298, 0.07218020}, {0.01933062, 0.11919716, 0.95037259}};
inline constexpr double rgb_of_xyz[3][3] = {{3.24100326, -1.53739899, -0.49861587},
                                            {-0.96922426, 1.87592999, 0.04155422},
                                            {0.05563942, -0.20401120, 1.05714897}};
inline constexpr double white[3] = {0.950428545, 1.0, 1.088900371};

[[nodiscard]] inline Colour times(const double (&m)[3][3], Colour c) {
  Colour out{};
  for (std::size_t k = 0; k < 3; ++k)
    out[k] =
        (static_cast<float>(m[k][0]) * c[0] + static_cast<float>(m[k][1]) * c[1]) + static_cast<float>(m[k][2]) * c[2];
  return out;
}

// Table by byte that undoes the transfer curve of sRGB.
[[nodiscard]] inline std::array<float, 256> linear_of_srgb() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double v = static_cast<double>(i) / 255;
    table[i] = static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  }
  return table;
}

// YCxCz: CIELAB without its cube roots, so that filtering is linear in light.
[[nodiscard]] inline Colour opponent_of_linear(Colour rgb) {
  const Colour xyz = times(xyz_of_rgb, rgb);
  const float x = xyz[0] / static_cast<float>(white[0]), y = xyz[1] / static_cast<float>(white[1]),
              z = xyz[2] / static_cast<float>(white[2]);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

[[nodiscard]] inline Colour linear_of_opponent(Colour c) {
  const float y = (c[0] + 16) / 116, x = y + c[1] / 500, z = y - c[2] / 200;
  return times(rgb_of_xyz,
               {x * static_cast<float>(white[0]), y * static_cast<float>(white[1]), z * static_cast<float>(white[2])});
}

// Cube root of a number in (0, 10], within 2 units in the last place, without a call or a branch: loops over pixels
// become vectors. A third of the exponent is a guess within 4 %, of which two steps of Halley leave nothing.
[[nodiscard]] inline float cube_root(float t) {
  float y = std::bit_cast<float>(std::bit_cast<std::uint32_t>(t) / 3 + 0x2a5137a0u);
  for (int step = 0; step < 2; ++step) {
    const float cube = y * y * y;
    y = y * (cube + 2 * t) / (2 * cube + t);
  }
  return y;
}

[[nodiscard]] inline Colour lab_of_linear(Colour rgb) {
  constexpr float delta = 6.0f / 29, cube = delta * delta * delta;
  const auto f = [](float t) {
    const float root = cube_root(t > cube ? t : cube);
    return t > cube ? root : t / (3 * delta * delta) + 4.0f / 29;
  };
  const Colour xyz = times(xyz_of_rgb, rgb);
  const float x = f(xyz[0] / static_cast<float>(white[0])), y = f(xyz[1] / static_cast<float>(white[1])),
              z = f(xyz[2] / static_cast<float>(white[2]));
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

// Colours look weaker where it is dark: a and b times 0.01 L.
[[nodiscard]] inline Colour hunt_lab(Colour lab) { return {lab[0], 0.01f * lab[0] * lab[1], 0.01f * lab[0] * lab[2]}; }

// Clamps a filtered colour to the colours of the screen.
[[nodiscard]] inline Colour hunt_lab_of_opponent(Colour ycc) {
  Colour rgb = linear_of_opponent(ycc);
  for (float& v : rgb) v = std::clamp(v, 0.0f, 1.0f);
  return hunt_lab(lab_of_linear(rgb));
}

[[nodiscard]] inline float hyab(Colour a, Colour b) {
  const float da = a[1] - b[1], db = a[2] - b[2];
  return std::abs(a[0] - b[0]) + std::sqrt(da * da + db * db);
}

// Published constants: exponents of colours and features, and the bend of the map from HyAB to [0, 1].
inline constexpr float colour_exponent = 0.7f, feature_exponent = 0.5f, bend_at = 0.4f, bend_to = 0.95f;

// The largest distance that counts: pure green from pure blue, to the power of the exponent.
[[nodiscard]] inline float largest_distance() {
  static const float largest =
      std::pow(hyab(hunt_lab(lab_of_linear({0, 1, 0})), hunt_lab(lab_of_linear({0, 0, 1}))), colour_exponent);
  return largest;
}

// Error of a distance by HyAB: in [0, 1].
[[nodiscard]] inline float colour_error(float distance) {
  const float largest = largest_distance(), bend = bend_at * largest, p = std::pow(distance, colour_exponent);
  if (p < bend) return p * (bend_to / bend);
  return bend_to + (p - bend) / (largest - bend) * (1 - bend_to);
}

// Error of a difference of features of luminance in [0, 1].
[[nodiscard]] inline float feature_error(float difference) {
  return std::sqrt(difference * 0.70710678f);  // to the power of feature_exponent, over sqrt(2)
}

}  // namespace lodestone::flip
