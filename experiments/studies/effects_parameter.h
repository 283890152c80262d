// The parameter `effects`: which effects the pictures of an experiment take, and what is drawn where one of them is
// left out that moves vertices.
#pragma once

#include "experiments/studies/experiment.h"
#include "render/effects/plan.h"
#include "render/lod/radii.h"

namespace lodestone {

// "auto", "all", "none", or names separated by commas, as `render --effects` takes them.
[[nodiscard]] ParameterInfo effects_parameter(const std::string& description);
[[nodiscard]] EffectRequest effect_request(const Parameters& parameters);

// The surface that these effects draw. Without geomorph every vertex is where its own level has it: what cracks and
// jumps then is not the morph that the radii promise.
class DrawnSurface {
 public:
  explicit DrawnSurface(const EffectRequest& effects);

  [[nodiscard]] bool morphs() const { return morphs_; }
  // The model as it is drawn. It refers to this object, and is good until the next call.
  [[nodiscard]] ModelFrame of(const ModelFrame& planned);

 private:
  bool morphs_;
  Radii own_;
};

}  // namespace lodestone
