#include "render/viewer/window/shown_pictures.h"

#include "render/viewer/controls/camera_control.h"
#include "render/viewer/window/widgets.h"

namespace lodestone::viewer {
namespace {

// The points of the measured distance that lie before the camera.
void show_measure(const ViewSession& session, const ViewRect& view, const PictureNotes& notes) {
  const Measure& measure = session.state.measure;
  std::vector<Vec3f> seen;
  for (const Vec3d point : measure.points)
    if (const auto at = session.drawing().project(view.settings, view.rect.size(), point)) seen.push_back(*at);
  const std::optional<double> length = distance(measure);
  notes.measure(seen, length ? text("%.6g", *length) : "");
}

void show_notes(const ViewSession& session, const ViewRect& view, const PictureNotes& notes) {
  const ViewState& state = session.state;
  const ViewDrawing& drawing = session.drawing();
  if (state.split) notes.name(view.settings == 0 ? "A" : "B");
  const ViewSettings& settings = state.settings[view.settings];
  const HeatRange radii = settings.boxes ? drawing.radii(view.settings) : HeatRange{};
  notes.legends(legends_of(settings, drawing.frame(view.settings), drawing.errors(), radii));
  notes.axes(axes_in_view(state.camera));
  show_measure(session, view, notes);
}

void show_surface(const ViewSession& session, const ViewRect& view, const PictureNotes& notes, Point pointer) {
  const ViewDrawing& drawing = session.drawing();
  const auto surface =
      drawing.surface_at(view.settings, view.rect.size(), pointer.x - view.rect.x, pointer.y - view.rect.y);
  if (!surface) return;
  notes.lines(drawing.box_lines(view.settings, view.rect.size(), *surface), false);
  show_facts(facts_of(*surface, drawing.scene_view(), session.state.camera), drawing.scene_view().model_count() > 1);
}

}  // namespace

// On the device where it can be.
void ShownPictures::keep(const ViewSession& session, std::size_t settings, ImageSize size, Renderer& renderer,
                         GlRenderer* gl) {
  Picture& picture = pictures_[settings];
  const bool band = session.state.settings[settings].band;
  kept_[settings] = true;
  if (gl && !band) return picture.copy_from(*gl, size);
  Image image = renderer.read_back();
  if (band) session.drawing().tint_band(settings, image);
  picture.set(image);
}

void ShownPictures::show(const ViewSession& session, ImageSize window, double pixels,
                         const std::optional<Point>& pointer) const {
  const ViewState& state = session.state;
  const ViewDrawing& drawing = session.drawing();
  for (const ViewRect& view : layout(state, window)) {
    if (!kept_[view.settings]) continue;
    const PictureNotes notes(view.rect, pixels);
    pictures_[view.settings].fit(view.rect.size());
    notes.picture(pictures_[view.settings].texture());
    if (state.settings[view.settings].boxes) notes.lines(drawing.box_lines(view.settings, view.rect.size()), true);
    notes.lines(drawing.frozen_lines(view.settings, view.rect.size()), false);
    if (!state.panel) continue;
    show_notes(session, view, notes);
    if (state.probe && pointer && view.rect.contains(pointer->x, pointer->y))
      show_surface(session, view, notes, *pointer);
  }
}

}  // namespace lodestone::viewer
