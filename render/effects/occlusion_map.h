// Occlusion map: the material's image tells how much of the ambient light reaches a place; other light is not changed.
#pragma once

#include "render/effects/texture_mapping.h"
#include "render/frame/appearance.h"

namespace lodestone::effects {

inline constexpr EffectInfo occlusion_map{
    .effect = Effect::occlusion_map,
    .what = "creases that ambient light does not reach, from an image",
    .attributes = "texture coordinates, material",
    .passes = "",
    .called_for = [](const Frame& frame, const ModelFrame& m) -> std::string {
      if (!m.appearance.textures || !(frame.settings.lighting.ambient > 0)) return {};
      return has_occlusion_maps(*m.morph.hierarchy) ? "ambient light falls on materials with occlusion maps" : "";
    },
    .glsl =
        {
            .fragment = R"(
void occlusion_map(inout Surface s) {
  PlacedMap placed = materials[material].occlusion;
  if (instance_flag(textures_flag) && placed.map.x != no_texture)
    s.ambient *= 1.0 - materials[material].factors.x * (1.0 - texel_of(placed).r);
}
)",
        },
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

inline void occlusion_map(const ShadingJob& job, Surface& s, Int lanes) {
  lanes &= shows_materials(s);
  if (bits(lanes) == 0) return;
  Materials material;
  find_materials(job, s, material);
  const SurfaceTexture* of_lane[width];
  lanes &= find_textures(
      job, [&](int k) { return material[k]->occlusion_map; }, bits(lanes), of_lane);
  if (bits(lanes) == 0) return;
  Mapping room;
  const Mapping& m = mapping_of(job, s, material, &SurfaceMaterial::occlusion_place, room);
  const Float open = sampled<0, 1>(of_lane, m)[0] * (1.0f / 255);
  const Float strength = of_materials(material, [](const SurfaceMaterial& one) { return one.occlusion_strength; });
  s.ambient = select(lanes, s.ambient * (1.0f - strength * (1.0f - open)), s.ambient);
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
