// The opacity of a surface whose material is masked or blended (render/effects/transparency.h).
#pragma once

#include "render/effects/texture_mapping.h"
#include "render/effects/transparency.h"

#ifdef LODESTONE_SHADING_LANES
#include "render/effects/vertex_colours.h"
#endif

namespace lodestone::effects {

// Alpha of the vertices, for models that have colours.
inline constexpr std::string_view vertex_alpha_vertex = R"(
centroid out float vertex_alpha;
void find_vertex_alpha() {
  vertex_alpha = own_colour.a;
  if (lambda < 1.0) {
    float parent_alpha = unpackUnorm4x8(colours[parent]).a;
    vertex_alpha = lambda > 0.0 ? lambda * own_colour.a + (1.0 - lambda) * parent_alpha : parent_alpha;
  }
}
)";
inline constexpr std::string_view vertex_alpha_fragment = R"(
centroid in float vertex_alpha;
float alpha_of_vertices() { return vertex_alpha; }
)";
inline constexpr std::string_view no_vertex_alpha_fragment = "float alpha_of_vertices() { return 1.0; }\n";

// 0 where a masked material is not there.
inline constexpr std::string_view opacity_fragment = R"(
float opacity_of_material() {
  uint mode = materials[material].flags.x;
  if (mode == 0u) return 1.0;
  float alpha = materials[material].base_colour.a * alpha_of_vertices();
  uvec4 map = materials[material].colours;
  if (map.x != no_texture) alpha *= texel_and_alpha_of(map).a;
  if (mode == 1u) return alpha < materials[material].factors.y ? 0.0 : 1.0;
  return alpha;
}
)";

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

struct Opacities {
  Float value;
  Int solid;  // lanes of masked materials that hide all behind them
};

// Opacities of layers, times those of their models.
inline Opacities opacities(const ShadingJob& job, Surface& s) {
  const Float of_model = of_models(s, [](const ModelFrame& m) { return m.appearance.opacity; });
  const Int shown = s.seen & shows_materials(s);
  if (bits(shown) == 0) return {of_model, all(0)};
  Materials material;
  find_materials(job, s, material);
  const auto of_mode = [&](AlphaMode mode) {
    return shown & gathered([&](int k) { return material[k]->alpha_mode == mode ? -1 : 0; });
  };
  const Int masked = of_mode(AlphaMode::mask), blended = of_mode(AlphaMode::blend), either = masked | blended;
  if (bits(either) == 0) return {of_model, all(0)};
  Float alpha = of_materials(material, [](const SurfaceMaterial& m) { return m.alpha; }) * vertex_alphas(s);
  const SurfaceTexture* of_lane[width];
  const Int textured = find_textures(
      job, [&](int k) { return material[k]->texture; }, bits(either), of_lane);
  if (bits(textured) != 0)
    alpha = select(textured, alpha * (sampled<24, 1>(of_lane, mapping_of(job, s))[0] * (1.0f / 255)), alpha);
  const Int there = ~(alpha < of_materials(
                                  material, [](const SurfaceMaterial& m) { return m.alpha_cutoff; }));
  const Float share = select(masked, select(there, all(1.0f), all(0.0f)), select(blended, alpha, all(1.0f)));
  return {of_model * share, masked & there & (of_model >= 1.0f)};
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
