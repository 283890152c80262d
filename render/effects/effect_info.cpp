#include "render/effects/effect_info.h"

#include <algorithm>

#include "render/effects/ambient_occlusion.h"
#include "render/effects/directional_light.h"
#include "render/effects/emission.h"
#include "render/effects/fog.h"
#include "render/effects/geomorph.h"
#include "render/effects/head_light.h"
#include "render/effects/level_tint.h"
#include "render/effects/normal_map.h"
#include "render/effects/occlusion_map.h"
#include "render/effects/overdraw.h"
#include "render/effects/shadow.h"
#include "render/effects/smooth_normals.h"
#include "render/effects/texture.h"
#include "render/effects/transparency.h"
#include "render/effects/unlit.h"
#include "render/effects/vertex_colours.h"
#include "render/effects/wireframe.h"

namespace lodestone {

std::span<const EffectInfo, effect_count> effect_infos() {
  static const std::array<EffectInfo, effect_count> infos = [] {
    std::array<EffectInfo, effect_count> all{};
    for (std::size_t k = 0; k < effect_count; ++k) all[k].effect = static_cast<Effect>(k);
    for (const EffectInfo& info :
         {effects::geomorph, effects::smooth_normals, effects::vertex_colours, effects::texture, effects::normal_map,
          effects::occlusion_map, effects::level_tint, effects::head_light, effects::directional_light, effects::shadow,
          effects::unlit, effects::emission, effects::wireframe, effects::fog, effects::transparency,
          effects::ambient_occlusion, effects::overdraw})
      all[static_cast<std::size_t>(info.effect)] = info;
    return all;
  }();
  return infos;
}

std::string glsl_name(Effect effect) {
  if (effect == Effect::texture) return "base_texture";  // GLSL has a function of that name
  std::string name(name_of(effect));
  std::ranges::replace(name, '-', '_');
  return name;
}

}  // namespace lodestone
