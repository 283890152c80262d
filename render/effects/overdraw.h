// Overdraw: instead of the picture, how many triangles cover the centre of each pixel, hidden ones included, in the
// colours of shading::overdraw_ramp. Counts are those of the fill rule: neighbours along an edge never count twice.
// With four samples a pixel, too, it is the centre alone that counts. Depth is what it is without the effect and with
// one sample.
#pragma once

#include "render/effects/effect_info.h"

namespace lodestone::effects {

[[nodiscard]] inline bool counts_overdraw(const Frame& frame) {
  return frame.effects.contains(Effect::overdraw) && frame.setting.overdraw;
}

inline constexpr EffectInfo overdraw{
    .effect = Effect::overdraw,
    .what = "how many triangles lie over each other in a pixel",
    .attributes = "",
    .passes = "a count of the triangles over each pixel's centre, instead of the picture's",
    .called_for = [](const Frame& frame, const ModelFrame&) -> std::string {
      return frame.setting.overdraw ? "the overdraw is asked for" : "";
    },
    .of_picture = true,
};

}  // namespace lodestone::effects
