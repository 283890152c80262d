#include "render/viewer/view_drawing.h"

#include <algorithm>
#include <chrono>

#include "render/viewer/band_tint.h"

namespace lodestone::viewer {
namespace {

constexpr float wire_opacity = 0.6f;

class Stopwatch {
 public:
  [[nodiscard]] double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Vec3f head_light(const Camera& camera) {
  const Vec3d back = camera.position - camera.target;
  return to_float((1 / length(back)) * back);
}

bool equal(DetailLimits a, DetailLimits b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const DetailLimit& p, const DetailLimit& q) { return p.box == q.box && p.radius == q.radius; });
}

}  // namespace

void ViewDrawing::set_renderer(Renderer* renderer) {
  renderer_ = renderer;
  ++backend_revision_;
  upload();
}

void ViewDrawing::set_model(Model* model) {
  model_ = model;
  for (PerView& view : views_) view = {};
  last_limits_.clear();
  ++model_revision_;
  upload();
}

void ViewDrawing::upload() {
  if (!ready()) return;
  renderer_->upload(model_->hierarchy());
  ++counts_.uploads;
}

FrameKey ViewDrawing::key(const ViewState& state, std::size_t settings, ImageSize size) const {
  FrameKey key{state.camera,   state.settings[settings], state.metric,     size, state.frozen, 0,
               load_revision_, model_revision_,          backend_revision_};
  if (state.frozen) key.freezes = state.freezes;
  key.settings.boxes = false;  // drawn over the picture
  return key;
}

void ViewDrawing::stream(const ViewState& state, const std::vector<View>& views) {
  streaming_ = false;
  if (!ready() || !model_->resident || state.frozen || views.empty()) return;
  ResidentCells& resident = *model_->resident;
  // The largest radius of each level that any of them asks for: what is limited for it is limited for all.
  Radii largest;
  for (const View& view : views) {
    const Radii radii = make_radii(resident.hierarchy(), radii_config(state.settings[view.settings], state.metric,
                                                                      view.size, state.camera.vertical_fov));
    if (largest.select.empty()) largest = radii;
    for (std::size_t l = 0; l < radii.select.size(); ++l)
      largest.select[l] = std::max(largest.select[l], radii.select[l]);
  }
  const ImageSize widest = std::max_element(views.begin(), views.end(), [](const View& a, const View& b) {
                             return a.size.width * b.size.height < b.size.width * a.size.height;
                           })->size;
  const Frustum frustum = frustum_of(view_projection(state.camera, resident.hierarchy(), widest));
  resident.update(largest, viewpoint(state.camera, resident.hierarchy().transform), &frustum);
  renderer_->refresh(0, resident.went(), resident.came());
  const DetailLimits limits = resident.limits();
  streaming_ = !resident.went().empty() || !resident.came().empty() || !equal(limits, last_limits_);
  last_limits_.assign(limits.begin(), limits.end());
  if (streaming_) ++load_revision_;
}

bool ViewDrawing::complete() const { return !model_ || !model_->resident || model_->resident->complete(); }

std::uint64_t ViewDrawing::resident_bytes() const { return model_ && model_->resident ? model_->resident->bytes() : 0; }

void ViewDrawing::select(const ViewState& state, const ViewSettings& settings, const Camera& camera, ImageSize size,
                         Selected& out) {
  const Hierarchy& hierarchy = model_->hierarchy();
  out.radii = make_radii(hierarchy, radii_config(settings, state.metric, size, camera.vertical_fov));
  out.viewpoint = viewpoint(camera, hierarchy.transform);
  out.vp = view_projection(camera, hierarchy, size);
  out.limits.clear();
  if (model_->resident) {
    const DetailLimits limits = model_->resident->limits();
    out.limits.assign(limits.begin(), limits.end());
  }
  const Frustum frustum = frustum_of(out.vp);
  select_cells(hierarchy, out.radii, out.viewpoint, {&frustum, false, out.limits}, out.selection);
  ++counts_.selections;
}

MorphContext ViewDrawing::morph(const PerView& view) const {
  const Selected& shown = view.shown();
  return {&model_->hierarchy(), &shown.radii, view.blend, shown.viewpoint, shown.limits};
}

Frame ViewDrawing::frame_of(const ViewState& state, const ViewSettings& settings, const PerView& view,
                            ImageSize size) const {
  Frame frame;
  frame.size = size;
  frame.samples = settings.samples;
  frame.setting.level_tint = settings.tint ? 1.0f : 0.0f;
  frame.setting.wireframe = settings.wireframe ? wire_opacity : 0.0f;
  frame.setting.overdraw = settings.overdraw;
  frame.effects.set(Effect::overdraw, settings.overdraw);
  ModelFrame& model = frame.only();
  model.morph = morph(view);
  model.selection = &view.shown().selection;
  model.view_projection = view.vp;
  model.towards_eye = head_light(state.camera);
  model.effects.set(Effect::level_tint, settings.tint);
  model.effects.set(Effect::wireframe, settings.wireframe);
  return frame;
}

const ViewReport& ViewDrawing::draw(const ViewState& state, std::size_t settings, ImageSize size, ImageSize full_size) {
  const Stopwatch total;
  PerView& view = views_[settings];
  const ViewSettings& wanted = state.settings[settings];
  // Before anything changes: it refuses cameras that cannot be drawn.
  const ViewProjection vp = view_projection(state.camera, model_->hierarchy(), size);
  if (!state.frozen) {
    view.frozen.reset();
    select(state, wanted, state.camera, size, view.live);
  } else if (!view.frozen || view.freezes != state.freezes) {
    view.frozen.emplace();
    view.freezes = state.freezes;
    // What of a streamed model is there was chosen for the settings that were shown: others are shown with those.
    const PerView& other = views_[1 - settings];
    if (model_->resident && other.frozen && other.freezes == state.freezes)
      view.frozen = other.frozen;
    else
      select(state, wanted, state.frozen_from, full_size, *view.frozen);
  }
  view.vp = vp;
  view.blend = wanted.blend;
  view.report.select_milliseconds = total.milliseconds();
  view.report.visited = view.shown().selection.visited;
  view.report.admissible = view.shown().radii.admissible;

  view.report.stats = renderer_->draw(frame_of(state, wanted, view, size));
  ++counts_.draws;
  view.report.total_milliseconds = total.milliseconds();
  return view.report;
}

void ViewDrawing::tint_band(std::size_t settings, Image& image) const {
  const PerView& view = views_[settings];
  viewer::tint_band(image, view.vp, morph(view), scheduler_);
}

std::vector<Line> ViewDrawing::box_lines(std::size_t settings, ImageSize size) const {
  std::vector<Line> lines;
  if (!ready()) return lines;
  const PerView& view = views_[settings];
  for (const SelectedCell& selected : view.shown().selection.cells)
    if (selected.visible)
      project_box(view.vp, size, model_->hierarchy().cells[selected.cell].bounds, selected.level, lines);
  normalise_nearness(lines);
  return lines;
}

std::vector<Line> ViewDrawing::frozen_lines(std::size_t settings, ImageSize size) const {
  std::vector<Line> lines;
  const PerView& view = views_[settings];
  if (ready() && view.frozen) project_frustum(view.vp, size, view.frozen->vp, lines);
  return lines;
}

std::optional<Vec3d> ViewDrawing::pick(const ViewState& state, std::size_t settings, ImageSize size, int x, int y) {
  if (!ready()) return {};
  (void)draw(state, settings, size, size);
  const auto point = viewer::pick(renderer_->read_back(), views_[settings].vp, x, y);
  if (!point) return {};
  const Transform& transform = model_->hierarchy().transform;
  return transform.origin + transform.scale * *point;
}

}  // namespace lodestone::viewer
