// Ambient occlusion from the depth of the picture: scalable ambient obscurance (mcguire2012) with one pattern of points
// for all pixels, so that nothing is random and nothing must be blurred.
//
//     colour = colour (1 - strength fog through min(1, o)),
//     o = 5 / N sum over the points of max(0, 1 - t.t)^3 max(0, (t.n - bias) / (t.t + epsilon)),
//
// t being the vector to the surface seen at the point, over the radius, and n the normal, from the nearer of the
// neighbours' depths. fog is the share of a surface's colour that fog lets through, through that of transparent layers:
// a hardly visible surface is hardly darkened. It is done once a pixel, with several samples by the depth of the first
// one.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "render/effects/effect_info.h"

namespace lodestone::effects {

// True if darkening is requested; else there is no pass.
[[nodiscard]] inline bool has_occlusion_pass(const Frame& frame) {
  const AmbientOcclusion& o = frame.settings.ambient_occlusion;
  return frame.effects.contains(Effect::ambient_occlusion) && o.strength > 0 && o.radius > 0;
}

inline constexpr std::size_t occlusion_points = 16;
inline constexpr float occlusion_bias = 0.05f, occlusion_epsilon = 0.05f;
// No point lies farther off than this share of the picture's height: the radius is cut to what that is.
inline constexpr float occlusion_reach = 0.125f;

// Points on a spiral in the unit disc: equal parts of the radius, turning by the golden angle.
[[nodiscard]] inline std::array<std::array<float, 2>, occlusion_points> occlusion_pattern() {
  std::array<std::array<float, 2>, occlusion_points> points;
  for (std::size_t k = 0; k < occlusion_points; ++k) {
    const double radius = (static_cast<double>(k) + 0.5) / occlusion_points,
                 angle = 2.399963229728653 * (static_cast<double>(k) + 0.25);
    points[k] = {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle))};
  }
  return points;
}

// Parameters for both backends.
struct OcclusionJob {
  float tan_x = 1, tan_y = 1, near = 0, far = 0;  // Lens
  float strength = 0, radius = 0;
  float fog_density = 0;
};
[[nodiscard]] inline OcclusionJob occlusion_job(const Frame& frame) {
  const AmbientOcclusion& o = frame.settings.ambient_occlusion;
  const bool foggy = frame.all_effects().contains(Effect::fog);
  const Lens& lens = frame.lens;
  return {lens.tan_x, lens.tan_y, lens.near, lens.far, o.strength, o.radius, foggy ? frame.settings.fog.density : 0};
}

inline constexpr EffectInfo ambient_occlusion{
    .effect = Effect::ambient_occlusion,
    .what = "creases darken",
    .attributes = "",
    .passes = "darkening by the depth of the picture",
    .called_for = [](const Frame& frame, const ModelFrame&) -> std::string {
      const AmbientOcclusion& o = frame.settings.ambient_occlusion;
      return o.strength > 0 && o.radius > 0 ? "ambient occlusion is asked for" : "";
    },
    .of_picture = true,
};

}  // namespace lodestone::effects
