// Unlit: materials whose colours no light and no shadow change (KHR_materials_unlit).
#pragma once

#include "render/effects/texture_mapping.h"
#include "render/frame/appearance.h"

namespace lodestone::effects {

inline constexpr EffectInfo unlit{
    .effect = Effect::unlit,
    .what = "materials that no light changes",
    .attributes = "material",
    .passes = "",
    .called_for = [](const Frame& frame, const ModelFrame& m) -> std::string {
      if (!m.appearance.textures || !(frame.settings.lighting.ambient < 1)) return {};
      return has_unlit_materials(*m.morph.hierarchy) ? "materials are unlit" : "";
    },
    .glsl =
        {
            .fragment = R"(
void unlit(inout Surface s) {
  if (!instance_flag(textures_flag) || materials[material].flags.z == 0u) return;
  s.ambient = frame.ambient;
  s.light = 1.0;
}
)",
        },
};

}  // namespace lodestone::effects

#ifdef LODESTONE_SHADING_LANES
namespace lodestone::soft::LODESTONE_LANES {

inline void unlit(const ShadingJob& job, Surface& s, Int lanes) {
  lanes &= shows_materials(s);
  if (bits(lanes) == 0) return;
  Materials material;
  find_materials(job, s, material);
  lanes &= gathered([&](int k) { return material[k]->unlit ? -1 : 0; });
  s.ambient = select(lanes, all(job.frame->settings.lighting.ambient), s.ambient);
  s.light = select(lanes, all(1.0f), s.light);
}

}  // namespace lodestone::soft::LODESTONE_LANES
#endif
