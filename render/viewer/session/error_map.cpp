#include "render/viewer/session/error_map.h"

#include <utility>

namespace lodestone::viewer {
namespace {

double scene_error(const SceneView& scene, std::size_t model, const Cell& cell) {
  return double{cell.error} * scene.placement(model).scale;
}

}  // namespace

HeatRange error_range(const SceneView& scene) {
  HeatRange range;
  for (std::size_t m = 0; m < scene.model_count(); ++m)
    for (const Cell& cell : scene.hierarchy(m).cells) range.extend(scene_error(scene, m, cell));
  return range;
}

const Frame& ErrorMap::of(const Frame& frame, const SceneView& scene, const HeatRange& range) {
  const std::size_t steps = heat_steps + 1, models = frame.models.size();
  parts_.assign(models * steps, {});
  frame_ = frame;
  frame_.models.clear();
  for (std::size_t m = 0; m < models; ++m) {
    for (const SelectedCell& cell : frame.models[m].selection->cells) {
      const double error = scene_error(scene, m, scene.hierarchy(m).cells[cell.cell]);
      parts_[m * steps + static_cast<std::size_t>(heat_step(error, range))].cells.push_back(cell);
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
      model.tint = heat_colour(static_cast<int>(step));
    }
  }
  if (frame_.models.empty()) frame_.models = frame.models;
  return frame_;
}

}  // namespace lodestone::viewer
