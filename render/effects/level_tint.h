// Level tint: a hue for each level of the hierarchy (render/frame/shading.h), or ModelFrame::tint for all of a model.
#pragma once

#include "render/effects/effect_info.h"

#ifdef LODESTONE_SHADING_LANES
#include "render/frame/shading.h"
#include "render/surface/surface.h"
#endif

namespace lodestone::effects {

inline constexpr EffectInfo level_tint{
    .effect = Effect::level_tint,
    .what = "a hue for each level",
    .attributes = "level of the cell",
    .passes = "",
    .called_for = [](const Frame& frame, const ModelFrame&) -> std::string {
      return frame.settings.level_tint > 0 ? "a level tint is asked for" : "";
    },
    .glsl =
        {
            .vertex = R"(
flat out vec3 tint;
void level_tint() { tint = instances[instance].levels[level].tint.rgb; }
)",
            .fragment = R"(
flat in vec3 tint;
void level_tint(inout Surface s) {
  if (frame.level_tint > 0.0) s.colour = (1.0 - frame.level_tint) * s.colour + frame.level_tint * tint;
}
)",
        },
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

inline void level_tint(const ShadingJob& job, Surface& s, Int lanes) {
  const float share = job.frame->settings.level_tint;
  if (!(share > 0)) return;
  Points tint{};
  for (int k = 0; k < width; ++k) {
    const Vec3f t = s.cell[k]->model->tint.value_or(shading::tint_of(s.cell[k]->level));
    tint.x[k] = t.x, tint.y[k] = t.y, tint.z[k] = t.z;
  }
  const auto mix = [&](Float own, Float other) { return select(lanes, (1 - share) * own + share * other, own); };
  s.colour = {mix(s.colour.x, tint.x), mix(s.colour.y, tint.y), mix(s.colour.z, tint.z)};
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
