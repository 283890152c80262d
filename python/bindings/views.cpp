#include "python/bindings/views.h"

#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>

#include "experiments/command_line/exit_status.h"
#include "experiments/subjects/render.h"

namespace lodestone::python {
namespace {

RadiiConfig take_radii(Options& options) {
  std::optional<std::string> rule;
  std::string metric = "euclidean";
  options.take("radii", rule);
  options.take("metric", metric);
  std::optional<float> kappa0;
  options.take("kappa0", kappa0);
  RadiiConfig config = radii_config(rule.value_or(kappa0 ? "per-level" : "adaptive"), metric);
  config.kappa0 = kappa0;
  if (options.take("pixel_error", config.pixel_error) && config.kappa0)
    throw UsageError("kappa0 and pixel_error exclude each other; give one of them");
  options.take("beta", config.beta);
  options.take("delta", config.delta);
  return config;
}

}  // namespace

ImageSize take_size(Options& options) {
  ImageSize size;
  options.take<std::pair<int, int>>("size", size, [](std::pair<int, int> given) {
    return ImageSize{given.first, given.second};
  });
  return size;
}

ViewConfig take_view(Options& options) {
  ViewConfig config = view_config(Scene{}, take_size(options));
  options.take("samples", config.samples);
  config.radii = take_radii(options);
  options.take<std::string>("blend", config.blend, [](const std::string& name) { return blend_named(name); });
  options.take<std::string>("effects", config.effects, parse_effects);
  options.take<bool>("tint", config.settings.level_tint, [](bool tint) { return tint ? 1.0f : 0.0f; });
  return config;
}

SceneView view_of_model(const Model& model) {
  return SceneView(scene_of("model"), {OpenModel{.hierarchy = &model.hierarchy}});
}

}  // namespace lodestone::python
