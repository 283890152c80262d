// Mouse and keys to camera movements.
//
//              orbit                        fly
//     left     around the target            look around
//     right    pan (middle button, too)     pan
//     wheel    nearer, farther              speed
//     W A S D  -                            forwards, left, backwards, right; Q E down, up; shift: four times as fast
//     double   focus on the point under the pointer (both)
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "render/viewer/controls/view_state.h"

namespace lodestone::viewer {

enum class Button : std::uint8_t { left, right, middle };

struct Point {
  double x = 0, y = 0;  // pixels of the window, from its upper left corner
  friend bool operator==(const Point&, const Point&) = default;
};

struct KeyStroke {
  char key = 0;          // an upper-case letter
  bool pressed = false;  // false: released
  bool shift = false;
};

class Navigation {
 public:
  // `now` in seconds.
  void press(Button button, Point at, double now);
  void release(Button button, Point at, double now);
  // `view_height`: of the picture under the pointer, pixels.
  void move(ViewState& state, Point to, int view_height);
  void scroll(ViewState& state, double steps);
  // True if the key steers; then it is not an action.
  bool key(const ViewState& state, KeyStroke stroke);
  // Releases all keys and buttons: the window has lost the keyboard.
  void let_go();

  // Flies on for `seconds` while keys are held.
  void advance(ViewState& state, double seconds);
  [[nodiscard]] bool flying(const ViewState& state) const;
  [[nodiscard]] bool dragging() const { return dragged_.has_value(); }

  // The point that a double click asks to focus on, once.
  [[nodiscard]] std::optional<Point> take_focus();
  // The point of the last click with the left button, once; of a double click, too.
  [[nodiscard]] std::optional<Point> take_click();

 private:
  [[nodiscard]] Vec3d direction() const;

  std::optional<Button> dragged_;
  Point last_, pressed_at_;
  double pressed_when_ = 0;
  bool click_ = false;  // the pointer has not moved since it was pressed
  std::optional<Point> clicked_;
  double clicked_when_ = 0;
  std::optional<Point> focus_, clicked_at_;
  std::array<bool, 6> held_{};  // of steering_keys
  bool shift_ = false;
};

}  // namespace lodestone::viewer
