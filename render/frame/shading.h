// The shading formula that all backends share, so that their pictures agree.
//
//     colour = albedo (ambient + (1 - ambient) min(1, light)),  light = sum over lights of strength times cosine
//
// the cosine of the head light being |n . l|, with n the normal interpolated perspective-correctly over the triangle
// and normalised per pixel, l the unit vector towards the light. The absolute value lights both sides: open surfaces
// have no wrong one. That of the directional light is max(0, n . l), with n turned to the side of the triangle that
// faces the eye. Colours go to bytes as round(255 colour), without a transfer curve.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/math/vec3.h"

namespace lodestone::shading {

// Squared length below which an interpolated normal counts as this long: opposite normals light like ambient only.
inline constexpr float least_norm2 = 1e-12f;

// Bytes of FrameSettings::background, unless a scene has another.
inline constexpr std::array<std::uint8_t, 4> background_bytes{24, 26, 30, 255};

// Edges of triangles with the effect wireframe: colour, and half their width in pixels.
inline constexpr Vec3f wire_colour{0.05f, 0.06f, 0.08f};
inline constexpr float wire_half_width = 0.75f;
inline constexpr float wire_opacity = 0.6f;  // where none is given

// Hues of the levels with the effect level_tint, from the root on, repeating after the last. Neighbours differ in hue.
inline constexpr std::array<Vec3f, 8> level_tints{{{0.90f, 0.35f, 0.30f},
                                                   {0.95f, 0.70f, 0.25f},
                                                   {0.85f, 0.85f, 0.35f},
                                                   {0.45f, 0.80f, 0.40f},
                                                   {0.35f, 0.80f, 0.80f},
                                                   {0.35f, 0.55f, 0.95f},
                                                   {0.65f, 0.45f, 0.90f},
                                                   {0.90f, 0.50f, 0.75f}}};

// Albedo of the cut of a solid by a clipping plane.
inline constexpr Vec3f cut_albedo{0.85f, 0.45f, 0.30f};

// Colours of the effect overdraw, for 1 triangle over a pixel and every third one more: interpolated linearly between
// these; white from 16 on. Pixels without triangles keep the background.
inline constexpr std::array<Vec3f, 6> overdraw_ramp{{{0.10f, 0.12f, 0.45f},
                                                     {0.05f, 0.50f, 0.75f},
                                                     {0.20f, 0.70f, 0.35f},
                                                     {0.95f, 0.85f, 0.20f},
                                                     {0.95f, 0.40f, 0.10f},
                                                     {0.70f, 0.05f, 0.20f}}};
inline constexpr std::uint32_t overdraw_most = 16;

// `triangles` at least 1.
[[nodiscard]] constexpr Vec3f overdraw_colour(std::uint32_t triangles) {
  if (triangles >= overdraw_most) return {1, 1, 1};
  const std::uint32_t lower = (triangles - 1) / 3, part = (triangles - 1) % 3;
  if (part == 0) return overdraw_ramp[lower];
  const float share = static_cast<float>(part) / 3;
  return (1 - share) * overdraw_ramp[lower] + share * overdraw_ramp[lower + 1];
}

[[nodiscard]] constexpr Vec3f tint_of(int level) {
  return level_tints[static_cast<std::size_t>(level) % level_tints.size()];
}

// value in [0, 1].
[[nodiscard]] constexpr std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(value * 255 + 0.5f); }

}  // namespace lodestone::shading
