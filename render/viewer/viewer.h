// `lodestone view`: a window onto a model, until it is closed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "parallel/scheduler/scheduler.h"
#include "render/viewer/controls/view_state.h"
#include "render/viewer/session/model_loader.h"

namespace lodestone::viewer {

struct ViewerConfig {
  LoadConfig load;               // its paths are opened first; none: the window waits for files to be dropped
  std::string backend = "auto";  // soft, gl, or the faster of the two: gl where a graphics card draws, soft elsewhere
  ImageSize size;                // of the window
  ViewState state;               // settings and switches to begin with; its cameras come from model and path
  std::vector<Camera> path;      // a path to play, whose first camera is the one to begin with; may be empty
  std::filesystem::path folder = ".";  // for screenshots and recorded paths
  const CancelFlag* cancel = nullptr;  // ends the viewer: looked at five times a second
  // Receives messages, a line each, that a user should read even after the window is closed: the fallback to soft,
  // names of files written, files that could not be opened.
  std::function<void(const std::string&)> say;
};

// Counts for measurements; none of them grows while nothing moves.
struct ViewerResult {
  std::string backend, device;
  Camera camera;                                         // the last one
  std::uint64_t resident_bytes = 0;                      // of a streamed model
  bool complete = true;                                  // the last picture has all the detail that it needs
  std::uint64_t uploads = 0, selections = 0, draws = 0;  // of the model, by the backend
  std::uint64_t window_frames = 0;                       // shown, those included that draw the panel alone
  std::vector<std::string> files;                        // written
};

// Throws UnsupportedError where no window can be had, what opening the first file throws, Cancelled when
// config.cancel is set. Files dropped later that cannot be opened are a line.
[[nodiscard]] ViewerResult run_viewer(const ViewerConfig& config, Scheduler& scheduler);

}  // namespace lodestone::viewer
