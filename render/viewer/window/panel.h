// The panel of the viewer: facts that it shows and requests of the user, drawn by Dear ImGui beside the pictures.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/viewer/controls/layout.h"
#include "render/viewer/controls/view_state.h"
#include "render/viewer/session/model_loader.h"
#include "render/viewer/session/view_drawing.h"

namespace lodestone::viewer {

// Facts that the panel shows besides the state.
struct PanelFacts {
  Rect panel, pictures;                // their places in the window
  double pixels = 1;                   // of the picture to a unit of the window
  const Model* model = nullptr;        // empty: none is open yet
  std::string backend, device;         // as the renderer names them
  std::vector<std::string> backends;   // that can be chosen
  double radius = 1;                   // of the scene
  const Frame* frame = nullptr;        // of the chosen settings
  const ViewReport* report = nullptr;  // of the chosen settings' last frame
  std::vector<float> frame_milliseconds;
  double scale = 1;  // of the resolution
  bool recording = false, playing = false, has_path = false;
  std::optional<LoadStatus> loading;  // of the file that is being opened
  std::string loading_name;
  std::string message;  // the last thing that happened; empty: nothing
  bool message_is_error = false;
};

struct PanelRequests {
  std::vector<Action> actions;
  std::string backend;  // to change to; empty: no change
};

// Draws the panel, the progress of opening a file and the last message; changes the settings in `state`.
[[nodiscard]] PanelRequests draw_panel(const PanelFacts& facts, ViewState& state);

}  // namespace lodestone::viewer
