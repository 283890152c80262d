// The frames of the viewer: what a view shows of the scene, freezing it, and the call of the backend. No window, no
// clock of its own.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "render/frame/renderer.h"
#include "render/scene/scene_view.h"
#include "render/viewer/controls/view_state.h"
#include "render/viewer/session/error_map.h"
#include "render/viewer/session/model_loader.h"
#include "render/viewer/session/projection.h"
#include "render/viewer/session/surface_pick.h"

namespace lodestone::viewer {

// How the scene is drawn with these settings.
[[nodiscard]] ViewConfig view_config(const Scene& scene, const ViewState& state, std::size_t settings, ImageSize size);

struct ViewReport {
  FrameStats stats;
  double select_milliseconds = 0, total_milliseconds = 0;
  std::uint64_t selected = 0;  // cells, visible ones
};

class ViewDrawing {
 public:
  explicit ViewDrawing(Scheduler& scheduler) : scheduler_(scheduler) {}

  // Both must outlive their use; the models are uploaded when both are set. A model that cannot be drawn (InputError,
  // ResourceError) leaves none.
  void set_renderer(Renderer* renderer);
  void set_model(Model* model);
  [[nodiscard]] bool ready() const { return renderer_ && model_; }
  [[nodiscard]] const Model* model() const { return model_; }

  // The views of a window: which settings in how many pixels, now and at full resolution.
  struct View {
    std::size_t settings = 0;
    ImageSize size, full_size;
  };

  // Draws one of the views that are shown together, unless nothing has changed since it was drawn last: then false, and
  // nothing has been selected. After true the renderer has its picture. A selection that is frozen now is made for the
  // full resolution. Throws InputError for a camera that cannot be drawn, and what loading throws.
  bool draw(const ViewState& state, const View& view, const std::vector<View>& together);
  bool draw(const ViewState& state, std::size_t settings, ImageSize size) {
    const View view{settings, size, size};
    return draw(state, view, {view});
  }
  // Paints lambda over the picture of the last draw() with these settings.
  void tint_band(std::size_t settings, Image& image) const;

  // Over the picture of the last draw() with these settings: boxes of its cells, coloured by their radii if these are
  // by cell and else by level, that of one cell, and the frozen camera's view.
  [[nodiscard]] std::vector<Line> box_lines(std::size_t settings, ImageSize size) const;
  [[nodiscard]] std::vector<Line> box_lines(std::size_t settings, ImageSize size, const SurfacePoint& of) const;
  [[nodiscard]] std::vector<Line> frozen_lines(std::size_t settings, ImageSize size) const;
  // The frame of the last draw() with these settings; there must have been one.
  [[nodiscard]] const Frame& frame(std::size_t settings) const { return views_[settings].scene->frame(); }
  [[nodiscard]] const ViewReport& report(std::size_t settings) const { return views_[settings].report; }
  // A sphere around all models.
  [[nodiscard]] Sphere bounding_sphere() const { return views_.front().scene->bounding_sphere(); }
  [[nodiscard]] const HeatRange& errors() const { return errors_; }  // of all models
  // Radii by cell of the last draw() with these settings, in units of the scene, but those of finest cells, which are
  // never refined.
  [[nodiscard]] HeatRange radii(std::size_t settings) const;
  [[nodiscard]] const SceneView& scene_view() const { return *views_.front().scene; }

  // The surface at a point of the picture of the last draw() with these settings, shown in so many pixels.
  [[nodiscard]] std::optional<SurfacePoint> surface_at(std::size_t settings, ImageSize shown, double x, double y) const;
  // That point in the scene.
  [[nodiscard]] Vec3d in_scene(const SurfacePoint& surface) const {
    return scene_view().placement(surface.model)(surface.point);
  }
  // Where a point of the scene lies in that picture, as project() tells.
  [[nodiscard]] std::optional<Vec3f> project(std::size_t settings, ImageSize shown, Vec3d point) const;

  struct Counts {
    std::uint64_t uploads = 0, selections = 0, draws = 0;
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  struct PerView {
    std::optional<SceneView> scene;
    bool frozen = false, band = false, errors = false;
    ErrorMap error_map;
    std::uint64_t freezes = 0;              // that the frozen selection belongs to
    std::vector<ViewProjection> frozen_by;  // of each model, from the frozen camera
    ViewReport report;
  };
  void restart();
  // In units of the scene.
  [[nodiscard]] double scene_radius(std::size_t settings, std::size_t model, CellId cell) const;
  [[nodiscard]] ViewConfig config_of(const ViewState& state, std::size_t settings, ImageSize size);
  [[nodiscard]] const std::vector<bool>& closed_models();
  bool update(PerView& per_view, const Camera& camera, const ViewConfig& config, const std::vector<ViewConfig>& beside);
  void freeze(PerView& per_view, const ViewState& state, const View& view, const std::vector<ViewConfig>& beside);

  Scheduler& scheduler_;
  Renderer* renderer_ = nullptr;
  Model* model_ = nullptr;
  std::array<PerView, 2> views_;
  HeatRange errors_;
  mutable SurfaceAlpha alpha_;  // its textures are decoded when a surface is asked for
  std::vector<bool> closed_;    // models whose surface bounds a solid; empty until a clipping plane asks
  Counts counts_;
};

}  // namespace lodestone::viewer
