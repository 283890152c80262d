// Vertex colours: those of the corners, morphed as the corners are, interpolated over the triangle, times the albedo.
// They are shown as they are stored, in the sRGB encoding: the picture has no transfer curve (render/frame/shading.h).
// Their alpha counts where materials are masked or blended (render/effects/material_alpha.h).
#pragma once

#include "render/effects/effect_info.h"

#ifdef LODESTONE_SHADING_LANES
#include "render/surface/surface.h"
#endif

namespace lodestone::effects {

// Declared before any use of the vertices' colours.
inline constexpr std::string_view colours_vertex = R"(
layout(location = 5) in vec4 own_colour;
layout(std430, binding = 5) readonly restrict buffer Colours { uint colours[]; };
)";

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

// Channels of the colours of corner i from bit `First` on, in [0, 1], morphed as morph_vertex does. White in lanes
// whose model has none.
template <int First, std::size_t Count>
[[gnu::always_inline]] inline std::array<Float, Count> corner_colours(const Surface& s, std::size_t i) {
  const auto channels = [](Int packed) {
    std::array<Float, Count> values;
    for (std::size_t c = 0; c < Count; ++c)
      values[c] = to_float((packed >> (First + 8 * static_cast<int>(c))) & 255) / 255.0f;
    return values;
  };
  const auto stored = [](std::span<const Rgba8> colours, std::uint32_t v) {
    return colours.empty() ? -1 : std::bit_cast<std::int32_t>(colours[v]);
  };
  const auto own = [&](int k) { return stored(s.cell[k]->own->attributes.colours, s.v[k][i]); };
  const std::array<Float, Count> w = channels(gathered(own));
  if (!s.morphing) return w;
  const std::array<Float, Count> p = channels(gathered([&](int k) {
    return s.cell[k]->morphing ? stored(s.cell[k]->coarser->attributes.colours, parent_of(s, k, i)) : own(k);
  }));
  const Float lambda = corner_lambdas(s, i), rest = 1.0f - lambda;
  const Int is_own = lambda >= 1.0f, is_coarser = lambda <= 0.0f;
  const auto mix = [&](Float a, Float b) { return select(is_own, a, select(is_coarser, b, lambda * a + rest * b)); };
  std::array<Float, Count> mixed;
  for (std::size_t c = 0; c < Count; ++c) mixed[c] = mix(w[c], p[c]);
  return mixed;
}

// Lanes whose model shows colours of its vertices.
inline Int shows_vertex_colours(const Surface& s) {
  return gathered([&](int k) {
    const DrawnCell& cell = *s.cell[k];
    return cell.model->appearance.vertex_colours && !cell.own->attributes.colours.empty() ? -1 : 0;
  });
}

template <int First, std::size_t Count>
[[gnu::always_inline]] inline std::array<Float, Count> interpolated_colours(const Surface& s) {
  const auto a = corner_colours<First, Count>(s, 0), b = corner_colours<First, Count>(s, 1),
             c = corner_colours<First, Count>(s, 2);
  std::array<Float, Count> values;
  for (std::size_t k = 0; k < Count; ++k) values[k] = interpolated(s, a[k], b[k], c[k]);
  return values;
}

inline void vertex_colours(const ShadingJob&, Surface& s, Int lanes) {
  const Int shown = lanes & shows_vertex_colours(s);
  if (bits(shown) == 0) return;
  const auto [red, green, blue] = interpolated_colours<0, 3>(s);
  s.colour = select(shown, {s.colour.x * red, s.colour.y * green, s.colour.z * blue}, s.colour);
}

// 1 where the model shows no colours of its vertices.
inline Float vertex_alphas(const Surface& s) {
  const Int shown = shows_vertex_colours(s);
  return bits(shown) == 0 ? all(1.0f) : select(shown, interpolated_colours<24, 1>(s)[0], all(1.0f));
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
