#include "render/viewer/controls/view_state.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodestone::viewer {
namespace {

void scale_detail(ViewSettings& settings, float factor) {
  if (settings.by_kappa0)
    settings.kappa0 /= factor;
  else
    settings.pixel_error *= factor;
  settings = clamped(settings);
}

// The switch that an action only turns on and off; null for other actions.
bool* switch_of(Action action, ViewState& state) {
  switch (action) {
    case Action::toggle_panel:
      return &state.panel;
    case Action::toggle_split:
      return &state.split;
    case Action::toggle_tint:
      return &state.current().tint;
    case Action::toggle_errors:
      return &state.current().errors;
    case Action::toggle_band:
      return &state.current().band;
    case Action::toggle_boxes:
      return &state.current().boxes;
    case Action::toggle_wireframe:
      return &state.current().wireframe;
    case Action::toggle_overdraw:
      return &state.current().overdraw;
    case Action::toggle_probe:
      return &state.probe;
    case Action::toggle_measure:
      return &state.measure.on;
    case Action::toggle_clip:
      return &state.clip.on;
    default:
      return nullptr;
  }
}

}  // namespace

const std::vector<ActionKey>& action_keys() {
  static const std::vector<ActionKey> keys{{Action::toggle_panel, 'H', "panel"},
                                           {Action::toggle_steering, '\t', "orbit or fly"},
                                           {Action::go_home, '\n', "whole model"},
                                           {Action::toggle_split, 'X', "split screen"},
                                           {Action::choose_other, 'V', "other settings"},
                                           {Action::toggle_frozen, ' ', "freeze selection"},
                                           {Action::toggle_tint, 'T', "tint by level"},
                                           {Action::toggle_errors, 'F', "heat map of stored errors"},
                                           {Action::toggle_band, 'M', "blending band"},
                                           {Action::toggle_boxes, 'B', "cell boxes"},
                                           {Action::toggle_wireframe, 'G', "wireframe"},
                                           {Action::toggle_overdraw, 'O', "overdraw"},
                                           {Action::toggle_probe, 'I', "cell under the pointer"},
                                           {Action::toggle_measure, 'L', "measure a length"},
                                           {Action::toggle_clip, 'K', "clipping plane"},
                                           {Action::coarser, '-', "coarser"},
                                           {Action::finer, '+', "finer"},
                                           {Action::screenshot, 'C', "screenshot"},
                                           {Action::record, 'R', "record a path"},
                                           {Action::play, 'P', "play the path"},
                                           {Action::stop, '\x1b', "stop"}};
  return keys;
}

std::optional<Action> action_of(char key) {
  if (key == '=') key = '+';  // the same key without shift
  for (const ActionKey& known : action_keys())
    if (known.key == key) return known.action;
  return {};
}

void apply(Action action, ViewState& state) {
  if (bool* const on = switch_of(action, state)) {
    *on = !*on;
    return;
  }
  switch (action) {
    case Action::toggle_steering:
      state.steering = state.steering == Steering::orbit ? Steering::fly : Steering::orbit;
      return;
    case Action::toggle_frozen:
      state.frozen = !state.frozen;
      if (state.frozen) {
        state.frozen_from = state.camera;
        ++state.freezes;
      }
      return;
    case Action::choose_other:
      state.chosen = 1 - state.chosen;
      return;
    case Action::coarser:
      scale_detail(state.current(), std::numbers::sqrt2_v<float>);
      return;
    case Action::finer:
      scale_detail(state.current(), 1 / std::numbers::sqrt2_v<float>);
      return;
    default:
      return;
  }
}

void look_at(ViewState& state, const Sphere& all, const Camera& from) {
  state.home = state.camera = from;
  state.fly_speed = 0.5 * all.radius;
  state.frozen = false;
  state.measure.points.clear();
  state.clip = {};
}

}  // namespace lodestone::viewer
