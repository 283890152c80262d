// Emission: the light that a material gives off, its colour times its texture, added to what it reflects. Both are in
// the encoding of the picture (render/frame/shading.h), where lights are added, too; their sum is at most 1.
#pragma once

#include "render/effects/texture_mapping.h"
#include "render/frame/appearance.h"

namespace lodestone::effects {

inline constexpr EffectInfo emission{
    .effect = Effect::emission,
    .what = "light that materials give off",
    .attributes = "texture coordinates, material",
    .passes = "",
    .called_for = [](const Frame&, const ModelFrame& m) -> std::string {
      return m.appearance.textures && has_emission(*m.morph.hierarchy) ? "materials give off light" : "";
    },
    .glsl =
        {
            .fragment = R"(
void emission(inout Surface s) {
  if (!instance_flag(textures_flag)) return;
  vec3 own = materials[material].emission.rgb;
  PlacedMap placed = materials[material].emission_map;
  if (placed.map.x != no_texture) own *= texel_of(placed);
  s.colour = min(s.colour + own, vec3(1.0));
}
)",
        },
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

inline void emission(const ShadingJob& job, Surface& s, Int lanes) {
  lanes &= shows_materials(s);
  if (bits(lanes) == 0) return;
  Materials material;
  find_materials(job, s, material);
  Points own = vectors_of_materials(material, [](const SurfaceMaterial& m) { return m.emission; });
  const SurfaceTexture* of_lane[width];
  const Int textured = lanes & find_textures(
                                   job, [&](int k) { return material[k]->emission_map; }, bits(lanes), of_lane);
  if (bits(textured) != 0) {
    Mapping room;
    const Mapping& m = mapping_of(job, s, material, &SurfaceMaterial::emission_place, room);
    const Points map = scaled(all(1.0f / 255), texels(of_lane, m));
    own = select(textured, {own.x * map.x, own.y * map.y, own.z * map.z}, own);
  }
  const auto add = [](Float to, Float what) { return min(to + what, all(1.0f)); };
  s.colour = select(lanes, {add(s.colour.x, own.x), add(s.colour.y, own.y), add(s.colour.z, own.z)}, s.colour);
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
