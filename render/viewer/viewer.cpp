// The loop of the viewer: wait, handle events, move, draw changes, show.
#include "render/viewer/viewer.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "render/backends/gl/gl_renderer.h"
#include "render/backends/make_renderer.h"
#include "render/viewer/session/view_session.h"
#include "render/viewer/window/gui.h"
#include "render/viewer/window/panel.h"
#include "render/viewer/window/shown_pictures.h"
#include "render/viewer/window/window.h"

namespace lodestone::viewer {
namespace {

constexpr double idle_wait = 0.2;          // seconds between two looks at the cancel flag
constexpr double frame_period = 1 / 120.;  // minimum, if nothing else slows frames down
constexpr double patience = 1;             // seconds without a new cell before looking for them becomes leisurely
constexpr int settling_frames = 3;         // of the window after an event: the panel follows one frame behind

bool draws_in_software(const std::string& device) {
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "SwiftShader"})
    if (device.find(name) != std::string::npos) return true;
  return false;
}

class Viewer {
 public:
  Viewer(const ViewerConfig& config, Scheduler& scheduler)
      : config_(config),
        scheduler_(scheduler),
        window_("Lodestone", config.size),
        gui_(window_.handle()),
        session_({config.load, config.folder, Window::wake, config.say, config.size}, scheduler) {
    session_.state = config.state;
    choose_backend(config.backend);
    on_display_lost([this] {
      session_.save_recording(Window::now());
      if (config_.say) config_.say("the connection to the display was lost");
    });
  }

  // Files being opened may take a moment to end.
  ~Viewer() {
    window_.hide();
    on_display_lost({});
  }

  ViewerResult run() {
    session_.open(config_.load.paths, Window::now());
    while (!window_.closing()) {
      wait();
      if (config_.cancel && *config_.cancel) throw Cancelled{};
      step();
    }
    session_.save_recording(Window::now());
    return result();
  }

 private:
  // ---- backends ----

  void choose_backend(const std::string& name) {
    if (name != "gl" && name != "auto") return use(name);
    try {
      if (!window_.missing_gl45().empty()) throw UnsupportedError("OpenGL 4.5 is missing: " + window_.missing_gl45());
      auto gl = make_gl_renderer(window_.context());
      if (name == "auto" && draws_in_software(gl->device())) return use("soft");  // which is many times as fast
      session_.drawing().set_renderer(nullptr);
      gl_ = gl.get();
      renderer_ = std::move(gl);
      session_.drawing().set_renderer(renderer_.get());
    } catch (const Error& error) {  // no OpenGL 4.5, or not enough memory for the model
      session_.tell(std::string(error.what()) + "; drawing with soft instead", false, Window::now());
      use("soft");
    }
  }

  // A backend that reads its pictures back; gl shares the window's context instead.
  void use(const std::string& name) {
    if (const std::vector<std::string> known = picture_backend_names(); std::ranges::find(known, name) == known.end())
      throw InputError("unknown backend '" + name + "'; " + known_names(name, known));
    session_.drawing().set_renderer(nullptr);
    gl_ = nullptr;
    renderer_ = make_renderer(name, scheduler_);
    session_.drawing().set_renderer(renderer_.get());
  }

  // ---- the loop ----

  void wait() {
    const double now = Window::now();
    if (session_.animated() || streaming_ || settling_ > 0)
      window_.wait(std::clamp(stepped_at_ + frame_period - now, 0.0, frame_period));
    else if (lowered_)
      window_.wait(std::min(idle_wait, session_.resolution.until_rest(now)));
    else
      window_.wait(idle_wait);
  }

  void step() {
    const double now = stepped_at_ = Window::now();
    collect(now);
    const ImageSize size = window_.size();
    session_.fit_home(size, now);
    session_.advance(now);
    const std::vector<Event> events = window_.take_events();
    const bool message = session_.message(now) != nullptr;
    if (!events.empty() || message != std::exchange(had_message_, message)) settling_ = settling_frames;
    if (size.width < 1 || size.height < 1) return hear_without_picture(events, now);
    session_.state.scale = interface_scale(size, window_.content_scale() * static_cast<float>(gui_.pixels()));
    // Without changes of the interface the window is shown again only if a picture has changed.
    const bool drawn = settling_ == 0 && draw_views(size, session_.resolution.scale(now));
    if (settling_ == 0 && !drawn) return;
    settling_ = std::max(0, settling_ - 1);

    gui_.begin_frame(session_.state.scale);
    for (const Event& event : events) on_event(event, size);
    session_.use_clicks(size, now);
    session_.fit_home(size, now);
    session_.advance(now);
    const bool screenshot = session_.take_screenshot_request();
    if (!screenshot) show_panel(size, now);
    if (!drawn) (void)draw_views(size, screenshot ? 1 : session_.resolution.scale(now));
    if (session_.drawing().ready())
      pictures_.show(session_, size, gui_.pixels(),
                     screenshot || session_.navigation.dragging() ? std::nullopt : gui_.pointer());
    clear_window(size);
    gui_.end_frame();
    if (screenshot) {
      session_.save_screenshot(read_window(size, pictures_rect(session_.state, size)), now);
      settling_ = settling_frames;
      return;
    }
    window_.swap();
    ++window_frames_;
  }

  // A file that was opened, or how far it is.
  void collect(double now) {
    const bool first = !session_.drawing().model();
    const std::string name = session_.loader() ? session_.loader()->name() : "";
    try {
      if (session_.collect(now)) {
        show_name();
        if (first) session_.offer_path(config_.path);
      }
    } catch (const Cancelled&) {
      session_.tell(name + ": not opened", false, now);
      show_name();
    } catch (const Error& error) {
      // Files named on the command line must exist; files dropped into the window may be anything.
      if (first && !config_.load.paths.empty()) throw;
      session_.tell(error.what(), true, now);
      show_name();
    }
    if (session_.loader()) show_progress(*session_.loader());
  }

  void show_name() {
    const Model* model = session_.drawing().model();
    title_ = model ? model->name + " - Lodestone" : "Lodestone";
    window_.set_title(title_);
    settling_ = settling_frames;
  }

  void show_progress(const ModelLoader& loader) {
    const LoadStatus status = loader.status();
    std::string title = loader.name();
    title += ": " + status.phase;
    if (status.share) {
      title += ' ';
      title += std::to_string(static_cast<int>(*status.share * 100));
      title += " %";
    }
    title += " - Lodestone";
    if (title == title_) return;
    title_ = title;
    window_.set_title(title_);
    settling_ = std::max(settling_, 1);
  }

  void hear_without_picture(const std::vector<Event>& events, double now) {
    for (const Event& event : events)
      if (event.kind == Event::Kind::drop) drop(event, now);
    settling_ = 0;
  }

  void drop(const Event& event, double now) { session_.open({event.files.begin(), event.files.end()}, now); }

  void on_event(const Event& event, ImageSize size) {
    Navigation& navigation = session_.navigation;
    ViewState& state = session_.state;
    switch (event.kind) {
      case Event::Kind::press:
        if (!gui_.wants_mouse() && session_.drawing().ready()) navigation.press(event.button, event.at, event.time);
        return;
      case Event::Kind::release:
        navigation.release(event.button, event.at, event.time);
        return;
      case Event::Kind::move:
        navigation.move(state, event.at, size.height);
        return;
      case Event::Kind::scroll:
        if (!gui_.wants_mouse() && session_.drawing().ready()) navigation.scroll(state, event.amount);
        return;
      case Event::Kind::key_down:
      case Event::Kind::key_repeat:
        hear_key(event);
        return;
      case Event::Kind::key_up:
        (void)navigation.key(state, {.key = event.key, .pressed = false, .shift = event.shift});
        return;
      case Event::Kind::drop:
        drop(event, event.time);
        return;
      case Event::Kind::focus_lost:
        navigation.let_go();
        return;
      case Event::Kind::other:
        return;
    }
  }

  void hear_key(const Event& event) {
    if (gui_.wants_text()) return;
    if (session_.navigation.key(session_.state, {.key = event.key, .pressed = true, .shift = event.shift})) return;
    const std::optional<Action> action = action_of(event.key);
    const bool repeats = action == Action::coarser || action == Action::finer;
    if (action && (event.kind == Event::Kind::key_down || repeats)) session_.act(*action, event.time);
  }

  void show_panel(ImageSize size, double now) {
    const ViewState& state = session_.state;
    const ViewDrawing& drawing = session_.drawing();
    PanelFacts facts;
    facts.panel = panel_rect(state, size);
    facts.pictures = pictures_rect(state, size);
    facts.pixels = gui_.pixels();
    facts.model = drawing.model();
    facts.backend = std::string(renderer_->name());
    facts.device = gl_ ? gl_->device() : "";
    facts.backends = picture_backend_names();
    if (!window_.missing_gl45().empty()) std::erase(facts.backends, "gl");
    if (drawing.ready()) facts.radius = drawing.bounding_sphere().radius;
    if (drawing.ready()) facts.report = &drawing.report(state.chosen);
    if (pictures_.has(state.chosen) && drawing.ready()) facts.frame = &drawing.frame(state.chosen);
    facts.frame_milliseconds = session_.frame_times.in_order();
    facts.scale = shown_scale_;
    facts.recording = session_.recording();
    facts.playing = session_.playing();
    facts.has_path = session_.has_path();
    if (session_.loader()) {
      facts.loading = session_.loader()->status();
      facts.loading_name = session_.loader()->name();
    }
    if (const Message* message = session_.message(now)) {
      facts.message = message->text;
      facts.message_is_error = message->error;
    }
    const PanelRequests requests = draw_panel(facts, session_.state);
    for (const Action action : requests.actions) session_.act(action, now);
    if (!requests.backend.empty()) choose_backend(requests.backend);
  }

  // ---- pictures ----

  static ImageSize scaled(Rect rect, double scale) {
    const auto side = [scale](int full) { return std::max(1, static_cast<int>(full * scale + 0.5)); };
    return {side(rect.width), side(rect.height)};
  }

  // Draws what has changed; whether anything has.
  bool draw_views(ImageSize size, double scale) {
    if (!session_.drawing().ready()) return false;
    const double begin = Window::now();
    std::vector<ViewDrawing::View> views;
    for (const ViewRect& view : layout(session_.state, size))
      views.push_back({view.settings, scaled(view.rect, scale), view.rect.size()});
    bool drawn = false;
    guarded([&] {
      for (const ViewDrawing::View& view : views) {
        if (!session_.drawing().draw(session_.state, view, views)) continue;
        pictures_.keep(session_, view.settings, view.size, *renderer_, gl_);
        session_.warn(session_.drawing().report(view.settings).stats.warnings, begin);
        drawn = true;
      }
      session_.accept_camera();
    });
    const double end = Window::now();
    wait_for_cells(drawn, end);
    shown_scale_ = scale;
    lowered_ = scale < 1;
    if (!drawn) return false;
    settling_ = std::max(settling_, 1);  // the panel may have been made before
    session_.frame_times.add((end - begin) * 1e3);
    session_.resolution.drawn(scale, (end - begin) * 1e3);
    return true;
  }

  // Cells being loaded will arrive soon; cells beyond the budget will not.
  void wait_for_cells(bool drawn, double now) {
    if (drawn) streamed_at_ = now;
    const Model* model = session_.drawing().model();
    streaming_ = model && !session_.state.frozen && !model->opened.complete() && now - streamed_at_ < patience;
  }

  // An error of drawing or loading becomes a line; the window continues.
  template <class Body>
  void guarded(const Body& body) {
    try {
      body();
    } catch (const Error& error) {
      session_.refuse(error.what(), Window::now());
      show_name();
    }
  }

  ViewerResult result() const {
    const ViewDrawing::Counts& counts = session_.drawing().counts();
    ViewerResult result;
    result.backend = std::string(renderer_->name());
    if (gl_) result.device = gl_->device();
    result.camera = session_.state.camera;
    if (const Model* model = session_.drawing().model()) {
      result.resident_bytes = model->opened.resident_bytes();
      result.complete = model->opened.complete();
    }
    result.uploads = counts.uploads;
    result.selections = counts.selections;
    result.draws = counts.draws;
    result.window_frames = window_frames_;
    result.files = session_.written();
    return result;
  }

  const ViewerConfig& config_;
  Scheduler& scheduler_;
  Window window_;
  Gui gui_;
  ShownPictures pictures_;
  std::unique_ptr<Renderer> renderer_;
  GlRenderer* gl_ = nullptr;  // the renderer, where it is that one
  ViewSession session_;       // ends before the renderer that it draws with
  double shown_scale_ = 1, stepped_at_ = 0, streamed_at_ = 0;
  bool lowered_ = false, streaming_ = false, had_message_ = false;
  int settling_ = settling_frames;
  std::string title_;
  std::uint64_t window_frames_ = 0;
};

}  // namespace

ViewerResult run_viewer(const ViewerConfig& config, Scheduler& scheduler) { return Viewer(config, scheduler).run(); }

}  // namespace lodestone::viewer
