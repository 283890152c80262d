// State of the viewer as plain data: cameras, settings, switches. It knows no window.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/viewer/controls/clip_choice.h"
#include "render/viewer/controls/looks.h"
#include "render/viewer/controls/measure.h"
#include "render/viewer/controls/view_settings.h"

namespace lodestone::viewer {

enum class Steering : std::uint8_t {
  orbit,  // around the target
  fly,    // from the camera's own place
};

struct ViewState {
  Camera camera;
  Camera home;  // sees the whole model in a picture that is at least as wide as high
  Steering steering = Steering::orbit;
  double fly_speed = 1;  // model units a second

  std::array<ViewSettings, 2> settings;
  bool split = false;      // both settings side by side; otherwise the chosen one alone
  std::size_t chosen = 0;  // settings that keys and panel change
  DistanceMetric metric = DistanceMetric::euclidean;

  bool frozen = false;        // the selection remains that of frozen_from, whatever the camera does
  Camera frozen_from;         // the camera when it was frozen
  std::uint64_t freezes = 0;  // so far: tells one frozen selection from the next

  bool panel = true;  // the panel, and notes over the pictures: legends, axes, distance
  bool probe = true;  // notes on the cell under the pointer
  Measure measure;
  Looks looks;
  ClipChoice clip;
  float scale = 1;  // of text and controls (controls/layout.h)

  [[nodiscard]] ViewSettings& current() { return settings[chosen]; }
  [[nodiscard]] const ViewSettings& current() const { return settings[chosen]; }
};

// Actions of keys and of buttons of the panel.
enum class Action : std::uint8_t {
  toggle_panel,
  toggle_steering,
  toggle_split,
  toggle_frozen,
  toggle_tint,
  toggle_errors,
  toggle_band,
  toggle_boxes,
  toggle_wireframe,
  toggle_overdraw,
  toggle_probe,
  toggle_measure,
  toggle_clip,
  choose_other,  // of the two settings
  coarser,       // tolerance or radius by a factor of 2^(1/2)
  finer,
  go_home,
  screenshot,
  record,  // starts and ends
  play,    // the last path; starts and ends
  stop,    // playing, recording, building
  quit,
};

// The name of an action in the panel, and its key.
struct ActionKey {
  Action action;
  char key;  // '\t', '\x1b' and ' ' are the keys of that name; '\n' is Home
  std::string_view name;
};
[[nodiscard]] const std::vector<ActionKey>& action_keys();
[[nodiscard]] std::optional<Action> action_of(char key);

// Changes the state alone; the rest of the work (pictures, paths, moving home gently, the end) is left to it.
void apply(Action action, ViewState& state);

// Starts to look at a new scene: camera, home, speed of flight, nothing frozen. The settings are kept.
void look_at(ViewState& state, const Sphere& all, const Camera& from);

}  // namespace lodestone::viewer
