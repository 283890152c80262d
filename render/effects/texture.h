// Texture: the base colour of the triangle's material, times its texture, times the albedo. Textures are shown as they
// are stored, in the sRGB encoding: the picture has no transfer curve (render/frame/shading.h); a material's base
// colour, which is linear, is encoded first. Alpha is another effect (render/effects/transparency.h).
#pragma once

#include "render/effects/texture_mapping.h"
#include "render/frame/appearance.h"

namespace lodestone::effects {

inline constexpr EffectInfo texture{
    .effect = Effect::texture,
    .what = "colours and textures of materials",
    .attributes = "texture coordinates, material",
    .passes = "",
    .called_for = [](const Frame&, const ModelFrame& m) -> std::string {
      return m.appearance.textures && has_surface_colours(*m.morph.hierarchy) ? "its materials have colours or textures"
                                                                              : "";
    },
    .glsl =
        {
            .fragment = R"(
void base_texture(inout Surface s) {
  if (!instance_flag(textures_flag)) return;
  s.colour *= materials[material].base_colour.rgb;
  uvec4 map = materials[material].colours;
  if (map.x != no_texture) s.colour *= texel_of(map);
}
)",
        },
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

inline void texture(const ShadingJob& job, Surface& s, Int lanes) {
  lanes &= shows_materials(s);
  if (bits(lanes) == 0) return;
  Materials material;
  find_materials(job, s, material);
  const auto times = [&](Int where, const Points& factor) {
    s.colour = select(where, {s.colour.x * factor.x, s.colour.y * factor.y, s.colour.z * factor.z}, s.colour);
  };
  times(lanes, vectors_of_materials(material, [](const SurfaceMaterial& m) { return m.base_colour; }));
  const SurfaceTexture* of_lane[width];
  const Int textured = lanes & find_textures(
                                   job, [&](int k) { return material[k]->texture; }, bits(lanes), of_lane);
  if (bits(textured) == 0) return;
  times(textured, scaled(all(1.0f / 255), texels(of_lane, mapping_of(job, s))));
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
