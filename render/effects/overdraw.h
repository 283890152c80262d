// Overdraw: instead of the picture, the number of triangles that cover the centre of each pixel, hidden ones included,
// in the colours of shading::overdraw_ramp. Counts follow the fill rule: neighbours along an edge never count twice.
// With four samples a pixel, too, only the centre counts. Depth is that without the effect and with one sample.
#pragma once

#include "render/effects/effect_info.h"
#include "render/frame/shading.h"

namespace lodestone::effects {

[[nodiscard]] inline bool counts_overdraw(const Frame& frame) {
  return frame.effects.contains(Effect::overdraw) && frame.settings.overdraw;
}

inline constexpr EffectInfo overdraw{
    .effect = Effect::overdraw,
    .what = "how many triangles lie over each other in a pixel",
    .attributes = "",
    .passes = "a count of the triangles over each pixel's centre, instead of the picture's",
    .called_for = [](const Frame& frame, const ModelFrame&) -> std::string {
      return frame.settings.overdraw ? "the overdraw is asked for" : "";
    },
    .of_picture = true,
};

}  // namespace lodestone::effects
