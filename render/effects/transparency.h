// Transparency: models of opacity below 1 are drawn over the opaque ones, all of their layers in the order of their
// depths, in whatever order they are drawn (an A-buffer: carpenter1984; on gl as lists: yang2010). Each layer is shaded
// as an opaque surface is, fog included, and covers what is behind it by the opacity of its model. Among layers at the
// same depth `soft` takes the one that is drawn earlier first. Every layer counts, however many there are.
//
// The picture's depth remains that of the opaque surfaces. With several samples a pixel layers are sorted at each
// sample, and shaded once a triangle.
#pragma once

#include "render/effects/effect_info.h"

namespace lodestone::effects {

// True if the model is drawn as layers; else it is opaque, whatever its opacity.
[[nodiscard]] inline bool is_transparent(const Frame& frame, const ModelFrame& model) {
  return frame.effects.contains(Effect::transparency) && model.appearance.opacity < 1;
}

inline constexpr EffectInfo transparency{
    .effect = Effect::transparency,
    .what = "surfaces that one sees through",
    .attributes = "",
    .passes = "layers of the transparent models, sorted",
    .called_for = [](const Frame&, const ModelFrame& m) -> std::string {
      return m.appearance.opacity < 1 ? "its opacity is below 1" : "";
    },
    .of_picture = true,
};

}  // namespace lodestone::effects
