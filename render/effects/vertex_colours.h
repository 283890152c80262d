// Vertex colours: those of the corners, morphed as the corners are, interpolated over the triangle, times the albedo.
// They are shown as they are stored, in the sRGB encoding: the picture has no transfer curve (render/frame/shading.h).
// Their alpha is not shown.
#pragma once

#include "render/effects/effect_info.h"

#ifdef LODESTONE_SHADING_LANES
#include "render/surface/surface.h"
#endif

namespace lodestone::effects {

inline constexpr EffectInfo vertex_colours{
    .effect = Effect::vertex_colours,
    .what = "colours of the vertices",
    .attributes = "colour",
    .passes = "",
    .called_for = [](const Frame&, const ModelFrame& m) -> std::string {
      return m.appearance.vertex_colours && m.morph.hierarchy->attributes.colours ? "vertices have colours" : "";
    },
    .glsl =
        {
            .vertex = R"(
layout(location = 5) in vec4 own_colour;
layout(std430, binding = 5) readonly restrict buffer Colours { uint colours[]; };
centroid out vec3 vertex_colour;  // with several samples a pixel, not outside the triangle

void vertex_colours() {
  vertex_colour = own_colour.rgb;
  if (lambda < 1.0) {
    vec3 parent_colour = unpackUnorm4x8(colours[parent]).rgb;
    vertex_colour = lambda > 0.0 ? lambda * own_colour.rgb + (1.0 - lambda) * parent_colour : parent_colour;
  }
}
)",
            .fragment = R"(
centroid in vec3 vertex_colour;
void vertex_colours(inout Surface s) {
  if (instance_flag(colours_flag)) s.colour *= vertex_colour;
}
)",
        },
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

// Colours of corner i, each channel in [0, 1], morphed as morph_vertex does. White in lanes whose model has none.
[[gnu::always_inline]] inline Points corner_colours(const Surface& s, std::size_t i) {
  const auto channels = [](Int packed) -> Points {
    const auto unit = [&](int shift) { return to_float((packed >> shift) & 255) / 255.0f; };
    return {unit(0), unit(8), unit(16)};
  };
  const auto stored = [](std::span<const Rgba8> colours, std::uint32_t v) {
    return colours.empty() ? -1 : std::bit_cast<std::int32_t>(colours[v]);
  };
  const auto own = [&](int k) { return stored(s.cell[k]->own->attributes.colours, s.v[k][i]); };
  const Points w = channels(gathered(own));
  if (!s.morphing) return w;
  const Points p = channels(gathered([&](int k) {
    return s.cell[k]->morphing ? stored(s.cell[k]->coarser->attributes.colours, parent_of(s, k, i)) : own(k);
  }));
  const Float lambda = corner_lambdas(s, i), rest = 1.0f - lambda;
  const Int is_own = lambda >= 1.0f, is_coarser = lambda <= 0.0f;
  const auto mix = [&](Float a, Float b) { return select(is_own, a, select(is_coarser, b, lambda * a + rest * b)); };
  return {mix(w.x, p.x), mix(w.y, p.y), mix(w.z, p.z)};
}

inline void vertex_colours(const ShadingJob&, Surface& s, Int lanes) {
  const Int shown = lanes & gathered([&](int k) {
                      const DrawnCell& cell = *s.cell[k];
                      return cell.model->appearance.vertex_colours && !cell.own->attributes.colours.empty() ? -1 : 0;
                    });
  if (bits(shown) == 0) return;
  const Points c = interpolated(s, corner_colours(s, 0), corner_colours(s, 1), corner_colours(s, 2));
  s.colour = select(shown, {s.colour.x * c.x, s.colour.y * c.y, s.colour.z * c.z}, s.colour);
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
