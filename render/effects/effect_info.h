// Description of an effect: when a scene calls for it, what it reads and which passes it takes. Each effect has a file
// in this folder, with its code for each backend.
//
// Code for `gl` is source text, put together by render/backends/gl/shaders/draw_program.h. Code for `soft` is a
// function on the lanes of a group of pixels (render/surface), put together by render/backends/soft/resolve_kernel.h.
// It is compiled only after render/surface/lanes.h, which defines LODESTONE_SHADING_LANES.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "render/frame/frame.h"

namespace lodestone {

// Parts of the programs of `gl`, empty if there is nothing to do. The declarations are outside of main; `vertex` is a
// function `void NAME()` and `fragment` a function `void NAME(inout Surface s)`, NAME as glsl_name() has it; they are
// called in the order of the effects. `geometry` is a function `void NAME()`, called for each corner of a triangle; if
// an effect has one, the outputs of the vertex stage go through a geometry stage, which passes them on. For that stage
// alone, declarations of varyings are on lines of their own: "flat out vec3 tint;".
struct GlslCode {
  std::string_view vertex = {};
  std::string_view geometry = {};
  std::string_view fragment = {};
};

struct EffectInfo {
  Effect effect{};
  std::string_view what;        // in a few words
  std::string_view attributes;  // that it reads, of vertices or triangles; empty: none
  std::string_view passes;      // that it takes besides drawing the surface; empty: none
  // Why this model of the frame calls for it; empty: it does not.
  std::string (*called_for)(const Frame& frame, const ModelFrame& model) = nullptr;
  GlslCode glsl = {};
  bool of_picture = false;  // it is switched on for a picture as a whole (Frame::effects), not for each model
};

// The descriptions of all effects, in their order.
[[nodiscard]] std::span<const EffectInfo, effect_count> effect_infos();
[[nodiscard]] inline const EffectInfo& info_of(Effect effect) {
  return effect_infos()[static_cast<std::size_t>(effect)];
}

// The name of an effect as an identifier: "head_light".
[[nodiscard]] std::string glsl_name(Effect effect);

// True if any light reaches the models of the frame, so that normals matter.
[[nodiscard]] inline bool is_lit(const FrameSettings& settings) {
  const Lighting& l = settings.lighting;
  return l.ambient < 1 && (l.head > 0 || l.directional.strength > 0);
}

}  // namespace lodestone
