#include "render/effects/plan.h"

#include <map>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "render/frame/shading.h"

namespace lodestone {
namespace {

// Over the radius of the scene, and at a distance of it: at that of a camera that sees the whole scene some 60 % of the
// colour is left.
constexpr double usual_occlusion_radius = 0.1, usual_fog = 0.2;

std::string reason(const Frame& frame, const ModelFrame& model, Effect effect) {
  // A picture of counts shows no surface.
  if (frame.settings.overdraw && effect != Effect::geomorph && effect != Effect::overdraw) return {};
  const auto called_for = info_of(effect).called_for;
  return called_for ? called_for(frame, model) : std::string();
}

bool asks_for(const EffectRequest& request, const Frame& frame, const ModelFrame& model, Effect effect) {
  switch (request.kind) {
    case EffectRequest::Kind::all:
      return true;
    case EffectRequest::Kind::listed:
      return request.listed.contains(effect);
    case EffectRequest::Kind::automatic:
      break;
  }
  return !reason(frame, model, effect).empty();
}

}  // namespace

std::string effect_list() {
  std::string names;
  for (const std::string_view name : effect_names) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

EffectRequest parse_effects(const std::string& text) {
  if (text == "auto") return {};
  if (text == "all") return {EffectRequest::Kind::all, {}, {}};
  EffectRequest request{EffectRequest::Kind::listed, {}, {}};
  if (text == "none") return request;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, comma - begin);
    const std::optional<Effect> effect = effect_named(name);
    if (!effect) {
      std::vector<std::string> known{"auto", "all", "none"};
      known.insert(known.end(), effect_names.begin(), effect_names.end());
      throw InputError("unknown effect '" + name + "'; " + known_names(name, known));
    }
    request.listed.insert(*effect);
    begin = comma + 1;
  }
  return request;
}

std::string to_text(const EffectRequest& request) {
  if (request.kind == EffectRequest::Kind::automatic) return "auto";
  if (request.kind == EffectRequest::Kind::all) return "all";
  std::string names;
  for (const EffectInfo& info : effect_infos())
    if (request.listed.contains(info.effect)) names.append(names.empty() ? "" : ",").append(name_of(info.effect));
  return names.empty() ? "none" : names;
}

FrameSettings complete_settings(const FrameSettings& settings, const EffectRequest& request, double scene_radius) {
  FrameSettings complete = settings;
  const auto unset = [&](Effect effect, float strength) {
    return request.kind == EffectRequest::Kind::listed && request.listed.contains(effect) &&
           !request.without.contains(effect) && strength == 0;
  };
  if (unset(Effect::head_light, settings.lighting.head)) complete.lighting.head = 1;
  if (unset(Effect::directional_light, settings.lighting.directional.strength))
    complete.lighting.directional.strength = 1;
  if (unset(Effect::shadow, settings.lighting.directional.shadows ? 1 : 0))
    complete.lighting.directional.shadows = true;
  if (unset(Effect::level_tint, settings.level_tint)) complete.level_tint = 1;
  if (unset(Effect::wireframe, settings.wireframe)) complete.wireframe = shading::wire_opacity;
  if (unset(Effect::overdraw, settings.overdraw ? 1 : 0)) complete.overdraw = true;
  AmbientOcclusion& occlusion = complete.ambient_occlusion;
  if (unset(Effect::ambient_occlusion, occlusion.strength)) occlusion.strength = 1;
  if (unset(Effect::ambient_occlusion, occlusion.radius) || occlusion.radius == by_scene_size)
    occlusion.radius = static_cast<float>(usual_occlusion_radius * scene_radius);
  if (unset(Effect::fog, settings.fog.density) || settings.fog.density == by_scene_size)
    complete.fog.density = static_cast<float>(usual_fog / scene_radius);
  return complete;
}

void plan_effects(Frame& frame, const EffectRequest& request) {
  frame.effects = {};
  for (ModelFrame& model : frame.models) {
    model.effects = {};
    for (const EffectInfo& info : effect_infos()) {
      if (request.without.contains(info.effect) || !asks_for(request, frame, model, info.effect)) continue;
      model.effects.insert(info.effect);
      if (info.of_picture) frame.effects.insert(info.effect);
    }
  }
}

std::vector<PlannedEffect> explain_plan(const Frame& frame) {
  std::vector<PlannedEffect> plan;
  const EffectSet running = frame.all_effects();
  for (const EffectInfo& info : effect_infos()) {
    PlannedEffect planned{info.effect, running.contains(info.effect), false, {}};
    for (std::uint32_t m = 0; m < frame.models.size(); ++m)
      if (std::string why = reason(frame, frame.models[m], info.effect); !why.empty())
        planned.reasons.push_back({m, std::move(why)});
    planned.called_for = !planned.reasons.empty();
    plan.push_back(std::move(planned));
  }
  return plan;
}

std::string to_text(const std::vector<PlannedEffect>& plan, const std::vector<std::string>& model_names) {
  std::string text;
  for (const PlannedEffect& planned : plan) {
    const EffectInfo& info = info_of(planned.effect);
    std::string line(name_of(planned.effect));
    line.resize(20, ' ');
    line += planned.runs ? "runs  " : "-     ";
    if (!planned.called_for) {
      line += planned.runs ? "asked for, though nothing calls for it" : "not called for";
    } else {
      // Models that share a reason share its mention.
      std::map<std::string, std::vector<std::uint32_t>> models_by_reason;
      for (const auto& [model, why] : planned.reasons) models_by_reason[why].push_back(model);
      std::string whys;
      for (const auto& [why, models] : models_by_reason) {
        whys += (whys.empty() ? "" : "; ") + why;
        if (models.size() == model_names.size()) continue;
        whys += " (";
        for (std::size_t k = 0; k < models.size(); ++k)
          whys += (k ? ", " : "") + (models[k] < model_names.size() ? model_names[models[k]] : "?");
        whys += ")";
      }
      line += planned.runs ? whys : "left out, though called for: " + whys;
    }
    if (planned.runs && !info.attributes.empty()) line += " [reads " + std::string(info.attributes) + "]";
    if (planned.runs && !info.passes.empty()) line += " [passes: " + std::string(info.passes) + "]";
    text += line + '\n';
  }
  return text;
}

}  // namespace lodestone
