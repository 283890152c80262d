#include "experiments/studies/effects_parameter.h"

#include "experiments/systems/lod_system.h"

namespace lodestone {

ParameterInfo effects_parameter(const std::string& description) {
  const auto usual_form = [](const std::string& text) { return to_text(parse_effects(text)); };
  return as_condition({"effects",
                       "auto",
                       "",
                       description,
                       0,
                       0,
                       {"auto", "all", "none"},
                       OtherTexts{"or several of " + effect_list() + " (one text, separated by commas)", usual_form}});
}

EffectRequest effect_request(const Parameters& parameters) { return parse_effects(parameters.text("effects")); }

DrawnSurface::DrawnSurface(const EffectRequest& effects)
    : morphs_(effects.kind != EffectRequest::Kind::listed || effects.listed.contains(Effect::geomorph)) {}

ModelFrame DrawnSurface::of(const ModelFrame& planned) {
  ModelFrame drawn = planned;
  if (morphs_) return drawn;
  own_ = without_morph(*planned.morph.radii);
  drawn.morph.radii = &own_;
  return drawn;
}

}  // namespace lodestone
