// Texture: the base colour of the triangle's material, times its texture, times the albedo. Textures are shown as they
// are stored, in the sRGB encoding: the picture has no transfer curve (render/frame/shading.h); a material's base
// colour, which is linear, is encoded first. Alpha is not shown.
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
  lanes &= of_models(s, [](const ModelFrame& m) { return m.appearance.textures ? 1.0f : 0.0f; }) > 0.0f;
  if (bits(lanes) == 0) return;
  Materials material;
  find_materials(job, s, material);
  const LaneThings<SurfaceMaterial> number{material, all_equal(material)};
  const auto base = [&](float Vec3f::*channel) {
    return as_float(
        number([&](const SurfaceMaterial& m) { return std::bit_cast<std::int32_t>(m.base_colour.*channel); }));
  };
  const auto times = [&](Int where, const Points& factor) {
    s.colour = select(where, {s.colour.x * factor.x, s.colour.y * factor.y, s.colour.z * factor.z}, s.colour);
  };
  times(lanes, {base(&Vec3f::x), base(&Vec3f::y), base(&Vec3f::z)});
  const SurfaceTexture* of_lane[width];
  const Int textured = lanes & find_textures(
                                   job, [&](int k) { return material[k]->texture; }, bits(lanes), of_lane);
  if (bits(textured) == 0) return;
  times(textured, scaled(all(1.0f / 255), texels(of_lane, mapping_of(job, s))));
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
