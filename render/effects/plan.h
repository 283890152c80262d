// Which effects a frame takes: those that its scene calls for, and no others.
//
// The plan is made per frame and per model; per cell the selection has decided already whether it morphs. A picture
// with the plan of `automatic` equals the one with everything switched on.
#pragma once

#include <string>
#include <vector>

#include "render/effects/effect_info.h"

namespace lodestone {

struct EffectRequest {
  enum class Kind : std::uint8_t { automatic, all, listed } kind = Kind::automatic;
  EffectSet listed;   // switched on whether called for or not, and no others
  EffectSet without;  // of any kind of request: never switched on
  friend bool operator==(const EffectRequest&, const EffectRequest&) = default;
};

// The names of all effects, separated by commas.
[[nodiscard]] std::string effect_list();

// "auto", "all", or names separated by commas ("none" for an empty list). Throws InputError for other names, with
// those that there are.
[[nodiscard]] EffectRequest parse_effects(const std::string& text);
// The text of it, names in the order of the effects.
[[nodiscard]] std::string to_text(const EffectRequest& request);

// The settings with nothing left open, in units of the scene: an effect that is listed by its name and has no strength
// gets a usual one, and a density or radius by the size of the scene follows from the radius of the sphere around it.
[[nodiscard]] FrameSettings complete_settings(const FrameSettings& settings, const EffectRequest& request,
                                              double scene_radius);

// Sets the effects of the frame and of its models, whose selections have been made.
void plan_effects(Frame& frame, const EffectRequest& request);

// An effect, if it runs, and why: a reason for each model that calls for it.
struct PlannedEffect {
  Effect effect{};
  bool runs = false, called_for = false;
  struct Reason {
    std::uint32_t model = 0;  // index in Frame::models
    std::string why;
  };
  std::vector<Reason> reasons;
};
// Explains a planned frame: all effects in their order.
[[nodiscard]] std::vector<PlannedEffect> explain_plan(const Frame& frame);

// A line for each effect: what runs, for which of the named models and why, and what does not.
[[nodiscard]] std::string to_text(const std::vector<PlannedEffect>& plan, const std::vector<std::string>& model_names);

}  // namespace lodestone
