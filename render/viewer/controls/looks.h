// Choices of the user about the whole scene: light, background, effects that are left out, models that are hidden. Both
// settings share them.
#pragma once

#include <vector>

#include "core/mesh/up_axis.h"
#include "render/scene/scene.h"

namespace lodestone::viewer {

struct Looks {
  Lighting lighting;
  Vec3d towards_light = Scene{}.towards_light;  // the directional light; any length but zero
  Vec3f background = FrameSettings{}.background;
  Fog fog;
  AmbientOcclusion ambient_occlusion;
  EffectSet without;         // effects that do not run, whatever calls for them
  std::vector<bool> hidden;  // by model; models beyond its end are shown
  friend bool operator==(const Looks&, const Looks&) = default;
};

// As the scene has it, with all models shown.
[[nodiscard]] Looks looks_of(const Scene& scene);

// Replaces values that are not finite or out of their ranges.
[[nodiscard]] Looks clamped(Looks looks);

// A direction as degrees about `up` and above the plane across it. A direction of no length has none: both 0.
struct Bearing {
  double around = 0, above = 0;
};
[[nodiscard]] Bearing bearing_of(Vec3d direction, Vec3d up);
[[nodiscard]] Vec3d direction_of(Bearing bearing, Vec3d up);  // of length 1

[[nodiscard]] inline bool is_hidden(const Looks& looks, std::size_t model) {
  return model < looks.hidden.size() && looks.hidden[model];
}
void show(Looks& looks, std::size_t model, bool shown);

}  // namespace lodestone::viewer
