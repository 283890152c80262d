#include "render/viewer/controls/view_settings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/viewer/controls/in_range.h"

namespace lodestone::viewer {
namespace {

std::string inadmissible(float kappa0, float least) {
  char text[160];
  std::snprintf(text, sizeof text, "kappa0 = %.3g cracks: it must exceed rho = %.4f, or be taken per level",
                static_cast<double>(kappa0), static_cast<double>(least));
  return text;
}

}  // namespace

ViewSettings clamped(ViewSettings settings) {
  const ViewSettings defaults;
  settings.pixel_error = in_range(settings.pixel_error, 0.05f, 1000, defaults.pixel_error);
  settings.kappa0 = in_range(settings.kappa0, 0.01f, 1000, defaults.kappa0);
  settings.beta = in_range(settings.beta, 0.01f, 100, defaults.beta);
  if (settings.samples != 4) settings.samples = 1;
  return settings;
}

RadiiConfig radii_config(const ViewSettings& settings, DistanceMetric metric) {
  const ViewSettings s = clamped(settings);
  RadiiConfig config;
  config.metric = metric;
  if (s.rule == (s.by_kappa0 ? RadiiRule::uniform : RadiiRule::adaptive)) config.rule = s.rule;
  if (s.by_kappa0) config.kappa0 = s.kappa0;
  config.pixel_error = s.pixel_error;
  config.beta = s.beta;
  return config;
}

Admissibility admissibility(std::span<const Hierarchy* const> models, const ViewSettings& settings,
                            DistanceMetric metric) {
  const RadiiConfig config = radii_config(settings, metric);
  Admissibility result;
  for (const Hierarchy* model : models) {
    result.least_kappa0 = std::max(result.least_kappa0, greatest_reach(*model, metric) + 3 * config.delta);
    result.admissible =
        result.admissible && (config.rule != RadiiRule::uniform || make_radii(*model, config).admissible);
  }
  result.continuous = settings.blend != Blend::step;
  if (!result.admissible) result.remark = inadmissible(*config.kappa0, result.least_kappa0);
  if (!result.continuous) {
    if (!result.remark.empty()) result.remark += "; ";
    result.remark += "the blending function step jumps: vertices pop";
  }
  return result;
}

}  // namespace lodestone::viewer
