// Geomorphing: vertices between their own place and their parent's (render/lod/morph.h), so that nothing cracks or
// pops. Its code is the vertex stage of each backend, morph_lambda and all that follows from it; a cell whose whole box
// has lambda = 1 takes the static path instead.
#pragma once

#include "render/effects/effect_info.h"

namespace lodestone::effects {

inline constexpr EffectInfo geomorph{
    .effect = Effect::geomorph,
    .what = "vertices move from their parents' places to their own",
    .attributes = "parent index, parent's attributes",
    .passes = "",
    .called_for = [](const Frame&, const ModelFrame& m) -> std::string {
      std::size_t moving = 0, drawn = 0;
      for (const SelectedCell& cell : m.selection->cells) {
        if (!cell.visible) continue;
        ++drawn;
        moving += cell.morphing;
      }
      if (moving == 0) return {};
      return std::to_string(moving) + " of " + std::to_string(drawn) + " cells are in a blending band";
    },
};

}  // namespace lodestone::effects
