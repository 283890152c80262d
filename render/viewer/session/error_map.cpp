#include "render/viewer/session/error_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lodestone::viewer {
namespace {

constexpr Vec3f without_error{0.75f, 0.75f, 0.75f};
// From the smallest error to the largest, interpolated linearly.
constexpr std::array<Vec3f, 5> ramp{{{0.15f, 0.25f, 0.75f},
                                     {0.10f, 0.65f, 0.80f},
                                     {0.35f, 0.80f, 0.35f},
                                     {0.95f, 0.80f, 0.20f},
                                     {0.90f, 0.20f, 0.15f}}};

double scene_error(const SceneView& scene, std::size_t model, const Cell& cell) {
  return double{cell.error} * scene.placement(model).scale;
}

}  // namespace

ErrorRange error_range(const SceneView& scene) {
  ErrorRange range;
  for (std::size_t m = 0; m < scene.model_count(); ++m)
    for (const Cell& cell : scene.hierarchy(m).cells) {
      const double error = scene_error(scene, m, cell);
      if (!(error > 0)) continue;
      range.least = range.most > 0 ? std::min(range.least, error) : error;
      range.most = std::max(range.most, error);
    }
  return range;
}

int error_step(double error, const ErrorRange& range) {
  if (!(error > 0) || !(range.most > 0)) return 0;
  if (!(range.most > range.least)) return 1;
  const double share = std::log(error / range.least) / std::log(range.most / range.least);
  return 1 + std::clamp(static_cast<int>(share * error_steps), 0, error_steps - 1);
}

double error_of_step(int step, const ErrorRange& range) {
  return range.least * std::pow(range.most / range.least, (step - 0.5) / error_steps);
}

Vec3f error_colour(int step) {
  if (step < 1) return without_error;
  const float at = static_cast<float>(step - 1) / (error_steps - 1) * static_cast<float>(ramp.size() - 1);
  const std::size_t lower = std::min(static_cast<std::size_t>(at), ramp.size() - 2);
  const float share = at - static_cast<float>(lower);
  return (1 - share) * ramp[lower] + share * ramp[lower + 1];
}

const Frame& ErrorMap::of(const Frame& frame, const SceneView& scene, const ErrorRange& range) {
  const std::size_t steps = error_steps + 1, models = frame.models.size();
  parts_.assign(models * steps, {});
  frame_ = frame;
  frame_.models.clear();
  for (std::size_t m = 0; m < models; ++m) {
    for (const SelectedCell& cell : frame.models[m].selection->cells) {
      const double error = scene_error(scene, m, scene.hierarchy(m).cells[cell.cell]);
      parts_[m * steps + static_cast<std::size_t>(error_step(error, range))].cells.push_back(cell);
    }
    // Shadows are thrown by the whole model, and its cut is filled, once.
    const Selection *casters = frame.models[m].casters, *solid = frame.models[m].solid;
    for (std::size_t step = 0; step < steps; ++step) {
      const Selection& part = parts_[m * steps + step];
      if (part.cells.empty() && !casters && !solid) continue;
      ModelFrame& model = frame_.models.emplace_back(frame.models[m]);
      model.selection = &part;
      model.casters = std::exchange(casters, nullptr);
      model.solid = std::exchange(solid, nullptr);
      model.tint = error_colour(static_cast<int>(step));
    }
  }
  if (frame_.models.empty()) frame_.models = frame.models;
  return frame_;
}

}  // namespace lodestone::viewer
