// The viewer between its window and its drawing: cameras in time, files that open, what has to be drawn when. Free of
// windows, so that tests can drive it.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/viewer/controls/camera_track.h"
#include "render/viewer/controls/navigation.h"
#include "render/viewer/session/frame_times.h"
#include "render/viewer/session/model_loader.h"
#include "render/viewer/session/resolution.h"
#include "render/viewer/session/view_drawing.h"

namespace lodestone::viewer {

// A line for people.
struct Message {
  std::string text;
  bool error = false;
  double until = 0;  // seconds
};

struct SessionConfig {
  LoadConfig load;  // for all files; the paths are replaced
  std::filesystem::path folder = ".";
  std::function<void()> wake;                   // ModelLoader's
  std::function<void(const std::string&)> say;  // may be empty
  ImageSize window{};                           // which the first camera is made for
};

class ViewSession {
 public:
  ViewSession(SessionConfig config, Scheduler& scheduler);

  ViewState state;
  Navigation navigation;
  ResolutionGovernor resolution;
  FrameTimes frame_times;

  [[nodiscard]] ViewDrawing& drawing() { return drawing_; }
  [[nodiscard]] const ViewDrawing& drawing() const { return drawing_; }

  // Begins to open files in the background, cancelling earlier ones; several meshes and hierarchies are shown together.
  // A camera path (.json that is not a tileset) is read at once and played.
  void open(const std::vector<std::filesystem::path>& files, double now);
  [[nodiscard]] const ModelLoader* loader() const { return loader_.get(); }
  // Shows the model that has been opened since; true when there is a new one. Throws what opening it threw.
  bool collect(double now);

  void act(Action action, double now);
  void play(std::vector<Camera> path, double now);
  // Puts the camera at the beginning of a path; Action::play flies it. Ignores an empty path.
  void offer_path(std::vector<Camera> path);
  [[nodiscard]] bool playing() const { return player_.playing(); }
  [[nodiscard]] bool recording() const { return recorder_.recording(); }
  [[nodiscard]] bool has_path() const { return !path_.empty(); }
  // Writes the recording, if there is one. To be called at the end, also when the display is lost.
  void save_recording(double now);

  // Moves the camera on: flight, transitions, playing; notes what moved for recording and resolution.
  void advance(double now);
  // Makes Home see the whole model in the pictures of a window of this size; a camera that is there remains there.
  void fit_home(ImageSize window, double now);
  // The camera moves by itself: the next frame is due at once.
  [[nodiscard]] bool animated() const;

  // Clicks since the last call: a double one focuses on the surface there; while measuring each sets a point.
  void use_clicks(ImageSize window, double now);
  // Focuses on the surface at a point of the window.
  void focus_at(Point at, ImageSize window, double now);

  // True if a screenshot is requested, once.
  [[nodiscard]] bool take_screenshot_request();
  // Writes the picture under the first free name; a failure is a message.
  void save_screenshot(const Image& image, double now);

  void tell(const std::string& text, bool error, double now);
  // Shows problems that are not errors, such as a missing texture.
  void warn(const std::vector<std::string>& warnings, double now);
  // The last message, as long as it is shown.
  [[nodiscard]] const Message* message(double now) const;
  [[nodiscard]] const std::vector<std::string>& written() const { return written_; }
  // The views could not be drawn: the camera goes back to the last one that could be, then home; when it is not the
  // camera, the model is given up.
  void refuse(const std::string& why, double now);
  void accept_camera() { drawable_ = state.camera; }

 private:
  [[nodiscard]] std::string free_name(const std::string& stem, const std::string& extension) const;
  [[nodiscard]] std::optional<Vec3d> point_at(Point at, ImageSize window) const;  // of the surface
  void show(std::unique_ptr<Model> model, double now);
  void say_guess() const;
  void toggle_recording(double now);
  void stop_moving();
  [[nodiscard]] std::vector<Camera> upright(std::vector<Camera> path) const;

  SessionConfig config_;
  ViewDrawing drawing_;
  std::unique_ptr<Model> model_;
  std::unique_ptr<ModelLoader> loader_;
  CameraRecorder recorder_;
  CameraPlayer player_;
  CameraTransition transition_;
  std::vector<Camera> path_;  // the last one recorded or given
  Camera home_;               // state.home, fitted to the pictures
  Camera seen_;               // at the last advance()
  Camera drawable_;
  double advanced_at_ = 0;
  bool was_flying_ = false;  // at the last advance()
  bool screenshot_ = false;
  std::optional<Message> message_;
  std::vector<std::string> written_;
};

}  // namespace lodestone::viewer
