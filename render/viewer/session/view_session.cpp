#include "render/viewer/session/view_session.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/mesh/up_axis.h"
#include "render/effects/plan.h"
#include "render/viewer/controls/camera_control.h"
#include "render/viewer/controls/layout.h"

namespace lodestone::viewer {
namespace {

namespace fs = std::filesystem;

constexpr double message_seconds = 6, error_seconds = 20;

bool is_camera_path(const fs::path& file) { return file.extension() == ".json" && file.filename() != "tileset.json"; }

// A scene defines how it is drawn; settings made by hand before are kept.
void take_settings(const Scene& scene, ViewState& state) {
  for (ViewSettings& settings : state.settings) {
    const ViewSettings untouched;
    if (settings.pixel_error == untouched.pixel_error) settings.pixel_error = scene.radii.pixel_error;
    if (settings.blend == untouched.blend) settings.blend = scene.blend;
    if (scene.radii.kappa0 && !settings.by_kappa0) {
      settings.by_kappa0 = true;
      settings.kappa0 = *scene.radii.kappa0;
      settings.rule = scene.radii.rule;
    }
    settings = clamped(settings);
  }
}

// The way of a scene, to be played. One down to a surface or along it has to know the surface, which a streamed model
// does not.
std::vector<Camera> way_through(const SceneView& scene, bool streamed, ImageSize size) {
  if (streamed && (scene.scene().camera.path == "fly-in" || scene.scene().camera.path == "walk")) return {};
  return camera_path(scene, size);
}

}  // namespace

ViewSession::ViewSession(SessionConfig config, Scheduler& scheduler)
    : config_(std::move(config)), drawing_(scheduler) {}

void ViewSession::open(const std::vector<fs::path>& files, double now) {
  if (files.empty()) return;
  try {
    if (is_camera_path(files.front())) {
      play(read_camera_keys(files.front().string(), {}), now);
      return;
    }
  } catch (const Error& error) {
    tell(error.what(), true, now);
    return;
  }
  loader_.reset();
  LoadConfig load = config_.load;
  load.paths = files;
  loader_ = std::make_unique<ModelLoader>(std::move(load), config_.wake);
}

bool ViewSession::collect(double now) {
  if (!loader_ || !loader_->ended()) return false;
  const std::unique_ptr<ModelLoader> loader = std::move(loader_);
  show(loader->take(), now);
  return true;
}

void ViewSession::show(std::unique_ptr<Model> model, double now) {
  try {
    drawing_.set_model(model.get());  // the renderer releases the old one before it ends
  } catch (const Error&) {
    drawing_.set_model(model_.get());
    throw;
  }
  model_ = std::move(model);
  stop_moving();
  path_.clear();
  const Sphere all = drawing_.bounding_sphere();
  Camera from = orbit_path(all, 1, {drawing_.scene_view().up(), aspect_of(config_.window)}).front();
  if (model_->is_scene_file) {
    take_settings(model_->scene, state);
    path_ = way_through(drawing_.scene_view(), model_->opened.streamed(), config_.window);
    if (!path_.empty()) from = path_.front();
  }
  say_guess();
  warn(model_->opened.warnings(), now);
  look_at(state, all, from);
  Scene scene = model_->scene;
  scene.settings = complete_settings(scene.settings, scene.effects, all.radius);
  state.looks = looks_of(scene);
  home_ = seen_ = drawable_ = state.camera;
}

// In the terminal only, as it comes with most models.
void ViewSession::say_guess() const {
  if (model_->scene.up || !config_.say) return;
  const std::string note = guess_note(model_->opened.models().front().hierarchy->transform.up);
  if (!note.empty()) config_.say(note);
}

void ViewSession::stop_moving() {
  player_.stop();
  transition_.stop();
  navigation.let_go();
}

void ViewSession::act(Action action, double now) {
  apply(action, state);
  switch (action) {
    case Action::go_home:
      player_.stop();
      transition_.start(now, state.camera, home_);
      return;
    case Action::screenshot:
      screenshot_ = true;
      return;
    case Action::record:
      toggle_recording(now);
      return;
    case Action::play:
      if (player_.playing())
        player_.stop();
      else if (path_.empty())
        tell("nothing to play yet: R records a path, or drop one (.json) into the window", false, now);
      else
        play(path_, now);
      return;
    case Action::stop:
      if (loader_) loader_->cancel();
      stop_moving();
      save_recording(now);
      return;
    default:
      return;
  }
}

// Keys without an up axis have that of the model.
std::vector<Camera> ViewSession::upright(std::vector<Camera> path) const {
  const Vec3d up = model_ ? drawing_.scene_view().up() : Vec3d{0, 0, 1};
  for (Camera& camera : path)
    if (camera.up == Vec3d{}) camera.up = up;
  return path;
}

void ViewSession::play(std::vector<Camera> path, double now) {
  if (path.empty()) return;
  transition_.stop();
  path_ = upright(std::move(path));
  player_.start(now, path_);
}

void ViewSession::offer_path(std::vector<Camera> path) {
  if (path.empty()) return;
  path_ = upright(std::move(path));
  state.camera = seen_ = path_.front();
}

void ViewSession::toggle_recording(double now) {
  if (recorder_.recording())
    save_recording(now);
  else
    recorder_.start(now, state.camera);
}

void ViewSession::save_recording(double now) {
  if (!recorder_.recording()) return;
  path_ = recorder_.stop(now);
  const std::string file = free_name("path", ".json");
  try {
    write_camera_path(file, path_);
    written_.push_back(file);
    tell("camera path: " + file, false, now);
  } catch (const Error& error) {
    tell(error.what(), true, now);
  }
}

void ViewSession::advance(double now) {
  if (std::exchange(was_flying_, navigation.flying(state))) navigation.advance(state, now - advanced_at_);
  advanced_at_ = now;
  if (const auto camera = transition_.advance(now)) state.camera = *camera;
  if (const auto camera = player_.advance(now)) state.camera = *camera;
  if (state.camera == seen_) return;
  seen_ = state.camera;
  recorder_.add(now, state.camera);
  resolution.moved(now);
}

void ViewSession::fit_home(ImageSize window, double now) {
  if (!drawing_.ready()) return;
  double narrowest = 1;
  for (const ViewRect& view : layout(state, window))
    narrowest = std::min(narrowest, static_cast<double>(view.rect.width) / view.rect.height);
  const Camera home = fitted(state.home, narrowest);
  const bool there = state.camera == std::exchange(home_, home);
  if (!there || state.camera == home) return;
  // A single step: a lower resolution is of no use to it.
  state.camera = seen_ = home;
  recorder_.add(now, home);
}

bool ViewSession::animated() const { return navigation.flying(state) || transition_.moving() || player_.playing(); }

std::optional<Vec3d> ViewSession::point_at(Point at, ImageSize window) const {
  for (const ViewRect& view : layout(state, window)) {
    if (!view.rect.contains(at.x, at.y)) continue;
    const auto surface = drawing_.surface_at(view.settings, view.rect.size(), at.x - view.rect.x, at.y - view.rect.y);
    if (surface) return drawing_.in_scene(*surface);
  }
  return {};
}

void ViewSession::use_clicks(ImageSize window, double now) {
  const auto click = navigation.take_click(), focus = navigation.take_focus();
  if (!state.measure.on) {
    if (focus) focus_at(*focus, window, now);
  } else if (click) {
    if (const auto point = point_at(*click, window)) add_point(state.measure, *point);
  }
}

void ViewSession::focus_at(Point at, ImageSize window, double now) {
  const auto point = point_at(at, window);
  if (!point) return;
  player_.stop();
  transition_.start(now, state.camera, focus(state.camera, *point));
}

bool ViewSession::take_screenshot_request() { return std::exchange(screenshot_, false); }

void ViewSession::save_screenshot(const Image& image, double now) {
  const std::string file = free_name("screenshot", ".png");
  try {
    write_png(file, image);
    written_.push_back(file);
    tell("screenshot: " + file, false, now);
  } catch (const Error& error) {
    tell(error.what(), true, now);
  }
}

std::string ViewSession::free_name(const std::string& stem, const std::string& extension) const {
  for (int number = 1;; ++number) {
    const std::string digits = std::to_string(number);
    const fs::path file =
        config_.folder / (stem + std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + digits + extension);
    std::error_code ignored;
    if (!fs::exists(fs::symlink_status(file, ignored))) return file.string();
  }
}

void ViewSession::tell(const std::string& text, bool error, double now) {
  message_ = Message{text, error, now + (error ? error_seconds : message_seconds)};
  if (config_.say) config_.say(text);
}

void ViewSession::warn(const std::vector<std::string>& warnings, double now) {
  constexpr std::size_t most = 10;
  if (warnings.empty()) return;
  std::vector<std::string> lines(warnings.begin(), warnings.begin() + std::min(most, warnings.size()));
  if (warnings.size() > most) lines.push_back(std::to_string(warnings.size() - most) + " more of the kind");
  std::string text;
  for (const std::string& line : lines) {
    if (!text.empty()) text += '\n';
    text += line;
    if (config_.say) config_.say(line);
  }
  message_ = Message{text, false, now + message_seconds};
}

const Message* ViewSession::message(double now) const {
  return message_ && now < message_->until ? &*message_ : nullptr;
}

void ViewSession::refuse(const std::string& why, double now) {
  tell(why, true, now);
  stop_moving();
  if (state.camera != drawable_) {
    state.camera = drawable_;
  } else if (state.camera != home_) {
    state.camera = home_;
  } else {
    drawing_.set_model(nullptr);
    model_.reset();
  }
}

}  // namespace lodestone::viewer
