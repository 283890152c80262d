// A window with an OpenGL context and its events, by GLFW.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "render/backends/gl/device/context.h"
#include "render/viewer/controls/navigation.h"

struct GLFWwindow;

namespace lodestone::viewer {

struct Event {
  enum class Kind : std::uint8_t {
    press,
    release,
    move,
    scroll,
    key_down,
    key_repeat,
    key_up,
    drop,        // of files
    focus_lost,  // another window has the keyboard
    other,       // something to redraw the window for
  };
  Kind kind = Kind::other;
  Button button = Button::left;
  Point at;           // pixels of the picture, from the upper left corner
  double amount = 0;  // of scrolling
  char key = 0;       // as in ActionKey
  bool shift = false;
  double time = 0;  // seconds
  std::vector<std::string> files{};
};

class Window {
 public:
  // At most one exists at a time, on the main thread. Throws UnsupportedError without a display or OpenGL 3.2.
  Window(const std::string& title, ImageSize size);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  [[nodiscard]] GLFWwindow* handle() const { return window_; }
  // Empty if the context is OpenGL 4.5 core; otherwise the reason why it is not.
  [[nodiscard]] const std::string& missing_gl45() const { return missing_gl45_; }
  // The window's context for a renderer, which the window outlives.
  [[nodiscard]] std::unique_ptr<GlContext> context() const;

  [[nodiscard]] ImageSize size() const;  // pixels of the picture; without pixels while it is minimised
  [[nodiscard]] bool closing() const;
  void close();
  void hide();                                // at once, whatever there is still to end
  [[nodiscard]] float content_scale() const;  // of text, where pixels are small; 1 is usual
  void set_title(const std::string& title);

  void poll();                // handles pending events
  void wait(double seconds);  // for events, at most this long
  [[nodiscard]] std::vector<Event> take_events();
  void swap();  // shows what was drawn
  // Ends a wait(), from any thread.
  static void wake();
  [[nodiscard]] static double now();  // seconds

 private:
  struct Callbacks;
  GLFWwindow* window_ = nullptr;
  std::string missing_gl45_;
  std::vector<Event> events_;
  Point pointer_;  // where the last movement ended: the pointer may be elsewhere when events are handled late
};

// Called, once, when the connection to the display is lost; the process ends with status 5 when it returns. It must not
// touch the window.
void on_display_lost(std::function<void()> callback);

}  // namespace lodestone::viewer
