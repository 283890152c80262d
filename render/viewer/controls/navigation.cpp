#include "render/viewer/controls/navigation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "render/viewer/controls/camera_control.h"

namespace lodestone::viewer {
namespace {

constexpr std::string_view steering_keys = "WASDQE";
constexpr std::array<Vec3d, 6> steering_ways{{{0, 0, 1}, {-1, 0, 0}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}}};

constexpr double double_click_seconds = 0.4, click_pixels = 4;
constexpr double radians_per_height = std::numbers::pi;  // of a drag over the height of the picture
constexpr double scroll_factor = 0.88;                   // of the distance, a step

double apart(Point a, Point b) { return std::hypot(a.x - b.x, a.y - b.y); }

}  // namespace

void Navigation::press(Button button, Point at, double now) {
  if (dragged_) return;  // the first button decides
  dragged_ = button;
  last_ = pressed_at_ = at;
  pressed_when_ = now;
  click_ = true;
}

void Navigation::release(Button button, Point at, double now) {
  if (dragged_ != button) return;
  dragged_.reset();
  const bool click = click_ && button == Button::left && apart(at, pressed_at_) <= click_pixels;
  if (click) clicked_at_ = at;
  if (!click) {
    clicked_.reset();
  } else if (clicked_ && now - clicked_when_ <= double_click_seconds && apart(at, *clicked_) <= click_pixels) {
    focus_ = at;
    clicked_.reset();
  } else {
    clicked_ = at;
    clicked_when_ = now;
  }
}

void Navigation::move(ViewState& state, Point to, int view_height) {
  if (!dragged_) return;
  if (click_ && apart(to, pressed_at_) <= click_pixels) return;  // a click with an unsteady hand
  click_ = false;
  const double height = std::max(view_height, 1);
  const double right = (to.x - last_.x) / height, up = -(to.y - last_.y) / height;
  last_ = to;
  if (*dragged_ != Button::left) {
    state.camera = pan(state.camera, -right, -up);  // the model follows the pointer
  } else if (state.steering == Steering::orbit) {
    state.camera = orbit(state.camera, right * radians_per_height, up * radians_per_height);
  } else {
    state.camera = look_around(state.camera, right * radians_per_height / 2, up * radians_per_height / 2);
  }
}

void Navigation::scroll(ViewState& state, double steps) {
  if (!std::isfinite(steps)) return;
  steps = std::clamp(steps, -20.0, 20.0);
  if (state.steering == Steering::orbit) {
    state.camera = dolly(state.camera, std::pow(scroll_factor, steps));
  } else {
    const double speed = state.fly_speed * std::pow(scroll_factor, -steps);
    if (speed > 1e-12 && speed < 1e12) state.fly_speed = speed;
  }
}

bool Navigation::key(const ViewState& state, KeyStroke stroke) {
  shift_ = stroke.shift;
  const std::size_t index = steering_keys.find(stroke.key);
  if (index == std::string_view::npos) return false;
  held_[index] = stroke.pressed && state.steering == Steering::fly;
  return state.steering == Steering::fly;
}

void Navigation::let_go() {
  held_.fill(false);
  dragged_.reset();
  clicked_.reset();
}

Vec3d Navigation::direction() const {
  Vec3d sum;
  for (std::size_t i = 0; i < held_.size(); ++i)
    if (held_[i]) sum = sum + steering_ways[i];
  return sum;
}

bool Navigation::flying(const ViewState& state) const {
  return state.steering == Steering::fly && direction() != Vec3d{};
}

void Navigation::advance(ViewState& state, double seconds) {
  if (!flying(state) || !(seconds > 0)) return;
  const double way = std::min(seconds, 0.25) * state.fly_speed * (shift_ ? 4 : 1);  // no leap after a slow frame
  state.camera = travel(state.camera, way * direction());
}

std::optional<Point> Navigation::take_focus() { return std::exchange(focus_, {}); }
std::optional<Point> Navigation::take_click() { return std::exchange(clicked_at_, {}); }

}  // namespace lodestone::viewer
