// Transparency: models of opacity below 1, and triangles of blended materials (AlphaMode::blend), are drawn over the
// opaque ones, all of their layers in the order of their depths, in whatever order they are drawn (an A-buffer:
// carpenter1984; on gl as lists: yang2010). Each layer is shaded as an opaque surface is, fog included, and covers what
// is behind it by its opacity: that of its model, times the alpha of a blended material. Among layers at the same depth
// `soft` takes the one that is drawn earlier first. Every layer counts, however many there are.
//
// A surface of a masked material (AlphaMode::mask) is opaque where its alpha reaches the material's cutoff, and not
// there elsewhere. `gl` discards such pixels; `soft`, whose visibility comes before shading, takes these surfaces as
// layers of opacity 0 or 1. Alpha is the base colour's, times that of its texture and of the vertices, once a triangle
// in a pixel. Shadows are as light (render/effects/shadow.h).
//
// The picture's depth remains that of the opaque surfaces, masked ones included. With several samples a pixel layers
// are sorted at each sample, and shaded once a triangle.
#pragma once

#include "render/effects/effect_info.h"
#include "render/frame/appearance.h"
#include "render/textures/surface_textures.h"

namespace lodestone::effects {

// True if the model is drawn as layers; else it is opaque, whatever its opacity.
[[nodiscard]] inline bool is_transparent(const Frame& frame, const ModelFrame& model) {
  return frame.effects.contains(Effect::transparency) && model.appearance.opacity < 1;
}

// True if any of its triangles lets others be seen behind it.
[[nodiscard]] inline bool has_layers(const Frame& frame, const ModelFrame& model) {
  return is_transparent(frame, model) || shows_alpha(frame, model, AlphaMode::blend);
}

// True if triangles of single-sided materials are drawn from one side only, whatever effects run.
[[nodiscard]] inline bool has_one_side(const ModelFrame& model) {
  return model.appearance.textures && has_one_sided_materials(*model.morph.hierarchy);
}

inline constexpr EffectInfo transparency{
    .effect = Effect::transparency,
    .what = "surfaces that one sees through",
    .attributes = "",
    .passes = "layers of the transparent surfaces, sorted",
    .called_for = [](const Frame&, const ModelFrame& m) -> std::string {
      if (m.appearance.opacity < 1) return "its opacity is below 1";
      const Hierarchy& hierarchy = *m.morph.hierarchy;
      const bool alpha = has_materials_of(hierarchy, AlphaMode::mask) || has_materials_of(hierarchy, AlphaMode::blend);
      return m.appearance.textures && alpha ? "materials are masked or blended" : "";
    },
    .of_picture = true,
};

}  // namespace lodestone::effects
