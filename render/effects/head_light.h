// Head light: parallel light along the view, from the eye. It lights both sides of a surface.
#pragma once

#include "render/effects/effect_info.h"

#ifdef LODESTONE_SHADING_LANES
#include "render/frame/shading.h"
#include "render/surface/surface.h"
#endif

namespace lodestone::effects {

inline constexpr EffectInfo head_light{
    .effect = Effect::head_light,
    .what = "light from the eye",
    .attributes = "",
    .passes = "",
    .called_for = [](const Frame& frame, const ModelFrame&) -> std::string {
      const Lighting& l = frame.settings.lighting;
      return l.head > 0 && l.ambient < 1 ? "a head light is on" : "";
    },
    .glsl =
        {
            .fragment = R"(
void head_light(inout Surface s) {
  float norm2 = dot(s.normal, s.normal);
  float cosine = abs(dot(s.normal, instances[instance].towards_eye.xyz)) / sqrt(max(norm2, least_norm2));
  s.light += frame.head_strength * min(cosine, 1.0);
}
)",
        },
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

inline void head_light(const ShadingJob& job, Surface& s, Int lanes) {
  const Points to = vectors_of_models(s, [](const ModelFrame& m) { return m.towards_eye; });
  const Float cosine = abs(dot(s.normal, to)) / sqrt(max(dot(s.normal, s.normal), all(shading::least_norm2)));
  s.light += as_float(lanes & as_int(job.frame->settings.lighting.head * min(cosine, all(1.0f))));
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
