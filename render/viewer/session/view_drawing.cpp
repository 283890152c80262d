#include "render/viewer/session/view_drawing.h"

#include <algorithm>

#include "parallel/scheduler/clock.h"
#include "render/culling/back_faces.h"
#include "render/frame/shading.h"
#include "render/viewer/session/band_tint.h"

namespace lodestone::viewer {

ViewConfig view_config(const Scene& scene, const ViewState& state, std::size_t settings, ImageSize size) {
  const ViewSettings& wanted = state.settings[settings];
  ViewConfig config = lodestone::view_config(scene, size);
  config.samples = wanted.samples;
  config.radii = radii_config(wanted, state.metric);
  config.radii.delta = scene.radii.delta;
  config.blend = wanted.blend;
  const Looks looks = clamped(state.looks);
  config.settings.lighting = looks.lighting;
  config.settings.background = looks.background;
  config.settings.fog = looks.fog;
  config.settings.ambient_occlusion = looks.ambient_occlusion;
  config.towards_light = looks.towards_light;
  config.effects.without = looks.without;
  config.hidden = looks.hidden;
  if (wanted.tint || wanted.errors) config.settings.level_tint = 1;
  if (wanted.wireframe) config.settings.wireframe = shading::wire_opacity;
  if (wanted.overdraw) config.settings.overdraw = true;
  return config;
}

void ViewDrawing::set_renderer(Renderer* renderer) {
  renderer_ = renderer;
  restart();
}

void ViewDrawing::set_model(Model* model) {
  model_ = model;
  try {
    restart();
  } catch (...) {
    model_ = nullptr;
    for (PerView& view : views_) view = {};
    throw;
  }
}

// Forgets all that was drawn before.
void ViewDrawing::restart() {
  for (PerView& view : views_) {
    view = {};
    if (model_) view.scene.emplace(model_->scene, model_->opened.models());
  }
  closed_.clear();
  if (model_) {
    errors_ = error_range(*views_.front().scene);
    alpha_.set_models(views_.front().scene->uploaded());
  }
  if (!ready()) return;
  views_.front().scene->upload(*renderer_);
  ++counts_.uploads;
}

ViewConfig ViewDrawing::config_of(const ViewState& state, std::size_t settings, ImageSize size) {
  ViewConfig config = view_config(model_->scene, state, settings, size);
  config.clip = plane_of(state.clip, bounding_sphere());
  if (config.clip) config.closed = closed_models();
  return config;
}

// A streamed model, of which cells are missing, may be open.
const std::vector<bool>& ViewDrawing::closed_models() {
  if (closed_.empty())
    for (const OpenModel& model : model_->opened.models())
      closed_.push_back(!model.resident && is_closed(*model.hierarchy, scheduler_));
  return closed_;
}

bool ViewDrawing::update(PerView& per_view, const Camera& camera, const ViewConfig& config,
                         const std::vector<ViewConfig>& beside) {
  const bool changed = per_view.scene->update(camera, config, beside);
  if (changed && !per_view.frozen) ++counts_.selections;
  return changed;
}

// Selects the cells that the frozen camera saw, unless they were drawn last, and keeps them.
void ViewDrawing::freeze(PerView& per_view, const ViewState& state, const View& view,
                         const std::vector<ViewConfig>& beside) {
  // The loaded cells of a streamed scene were chosen for a selection frozen before: this one is made from them.
  const PerView& other = &per_view == &views_[0] ? views_[1] : views_[0];
  const bool alike = model_->opened.streamed() && other.frozen && other.freezes == state.freezes;
  const std::size_t settings = alike ? 1 - view.settings : view.settings;
  const ViewConfig config = config_of(state, settings, view.full_size);
  // The renderer is told of loaded and removed cells when it draws.
  if (update(per_view, state.frozen_from, config, beside)) (void)per_view.scene->draw(*renderer_);
  per_view.scene->freeze(true);
  per_view.frozen = true;
  per_view.freezes = state.freezes;
  per_view.frozen_by.clear();
  for (const ModelFrame& model : per_view.scene->frame().models) per_view.frozen_by.push_back(model.view_projection);
}

bool ViewDrawing::draw(const ViewState& state, const View& view, const std::vector<View>& together) {
  const Stopwatch total;
  PerView& per_view = views_[view.settings];
  std::vector<ViewConfig> beside;
  for (const View& other : together)
    if (other.settings != view.settings) beside.push_back(config_of(state, other.settings, other.size));
  if (per_view.frozen && (!state.frozen || per_view.freezes != state.freezes)) {
    per_view.scene->freeze(false);
    per_view.frozen = false;
    per_view.frozen_by.clear();
  }
  if (state.frozen && !per_view.frozen) freeze(per_view, state, view, beside);

  const ViewSettings& wanted = state.settings[view.settings];
  const bool changed = update(per_view, state.camera, config_of(state, view.settings, view.size), beside);
  if (!changed && per_view.band == wanted.band && per_view.errors == wanted.errors) return false;
  ViewReport& report = per_view.report;
  report.select_milliseconds = total.milliseconds();
  const Frame& own = per_view.scene->frame();
  const Frame& frame = wanted.errors ? per_view.error_map.of(own, *per_view.scene, errors_) : own;
  // The band is painted over a picture that the renderer may have no more.
  report.stats = changed ? per_view.scene->draw(*renderer_, frame) : renderer_->draw(frame);
  per_view.band = wanted.band;
  per_view.errors = wanted.errors;
  report.selected = 0;
  for (const ModelFrame& model : per_view.scene->frame().models) report.selected += model.selection->cells.size();
  report.total_milliseconds = total.milliseconds();
  ++counts_.draws;
  return true;
}

void ViewDrawing::tint_band(std::size_t settings, Image& image) const {
  viewer::tint_band(image, views_[settings].scene->frame(), scheduler_);
}

std::vector<Line> ViewDrawing::box_lines(std::size_t settings, ImageSize size) const {
  std::vector<Line> lines;
  if (!ready()) return lines;
  const HeatRange range = radii(settings);
  const std::vector<ModelFrame>& models = frame(settings).models;
  for (std::size_t m = 0; m < models.size(); ++m) {
    if (!models[m].selection) continue;
    const std::vector<float>& by_cell = models[m].morph.radii->by_cell;
    for (const SelectedCell& selected : models[m].selection->cells) {
      if (!selected.visible) continue;
      const Vec3f colour = by_cell.empty() ? shading::tint_of(selected.level)
                                           : heat_colour(heat_step(scene_radius(settings, m, selected.cell), range));
      project_box(models[m].view_projection, size, models[m].morph.hierarchy->cells[selected.cell].bounds, colour,
                  lines);
    }
  }
  normalise_nearness(lines);
  return lines;
}

double ViewDrawing::scene_radius(std::size_t settings, std::size_t model, CellId cell) const {
  const SceneView& scene = *views_[settings].scene;
  return double{scene.frame().models[model].morph.radii->by_cell[cell]} * scene.placement(model).scale;
}

HeatRange ViewDrawing::radii(std::size_t settings) const {
  HeatRange range;
  const std::vector<ModelFrame>& models = frame(settings).models;
  for (std::size_t m = 0; m < models.size(); ++m)
    if (!models[m].morph.radii->by_cell.empty())
      for (CellId cell{0}; cell < models[m].morph.hierarchy->levels.back().first_cell; ++cell)
        range.extend(scene_radius(settings, m, cell));
  return range;
}

std::vector<Line> ViewDrawing::box_lines(std::size_t settings, ImageSize size, const SurfacePoint& of) const {
  std::vector<Line> lines;
  const ModelFrame& model = frame(settings).models[of.model];
  project_box(model.view_projection, size, model.morph.hierarchy->cells[of.cell].bounds, Vec3f{1, 1, 1}, lines);
  return lines;
}

std::vector<Line> ViewDrawing::frozen_lines(std::size_t settings, ImageSize size) const {
  std::vector<Line> lines;
  const PerView& view = views_[settings];
  // All models share the picture's space: the first one suffices.
  if (ready() && view.frozen)
    project_frustum(frame(settings).models.front().view_projection, size, view.frozen_by.front(), lines);
  return lines;
}

std::optional<Vec3f> ViewDrawing::project(std::size_t settings, ImageSize shown, Vec3d point) const {
  const SceneView& scene = *views_[settings].scene;
  return viewer::project(scene.frame().models.front().view_projection, shown, scene.placement(0).inverse(point));
}

std::optional<SurfacePoint> ViewDrawing::surface_at(std::size_t settings, ImageSize shown, double x, double y) const {
  if (!ready() || shown.width < 1 || shown.height < 1) return {};
  const ImageSize size = frame(settings).size;
  alpha_.prepare(frame(settings), scheduler_);
  return viewer::surface_at(frame(settings), alpha_, x * size.width / shown.width, y * size.height / shown.height);
}

}  // namespace lodestone::viewer
