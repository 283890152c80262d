// Fog: a surface at a distance d from the eye keeps a share exp(-density d) of its colour; the rest is the fog's
// colour. The background keeps its colour.
#pragma once

#include "render/effects/effect_info.h"

#ifdef LODESTONE_SHADING_LANES
#include "render/surface/surface.h"
#endif

namespace lodestone::effects {

inline constexpr EffectInfo fog{
    .effect = Effect::fog,
    .what = "what is far away fades",
    .attributes = "",
    .passes = "",
    .called_for = [](const Frame& frame, const ModelFrame&) -> std::string {
      return frame.settings.fog.density > 0 ? "the scene has fog" : "";
    },
    .glsl =
        {
            .fragment = R"(
void fog(inout Surface s) {
  if (!(frame.fog.w > 0.0)) return;
  vec2 at = (2.0 * gl_FragCoord.xy / frame.size - 1.0) * frame.lens.xy;
  float apart = sqrt(1.0 + dot(at, at)) / gl_FragCoord.w;
  float share = exp(-frame.fog.w * apart);
  s.colour = share * s.colour + (1.0 - share) * frame.fog.rgb;
}
)",
        },
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

inline void fog(const ShadingJob& job, Surface& s, Int lanes) {
  const Fog& fog = job.frame->settings.fog;
  if (!(fog.density > 0)) return;
  const Float apart = distances_from_eye(job, s);
  Float share;
  for (int k = 0; k < width; ++k) share[k] = std::exp(-fog.density * apart[k]);
  const auto mix = [&](Float own, float other) { return select(lanes, share * own + (1.0f - share) * other, own); };
  s.colour = {mix(s.colour.x, fog.colour.x), mix(s.colour.y, fog.colour.y), mix(s.colour.z, fog.colour.z)};
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
