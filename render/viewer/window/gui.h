// Dear ImGui in the viewer's window: its frame, and whose the mouse and the keyboard are.
#pragma once

#include <optional>

#include "render/viewer/controls/navigation.h"

struct GLFWwindow;

namespace lodestone::viewer {

class Gui {
 public:
  // The window's callbacks must be installed before: they are called first. Nothing is written to disk.
  explicit Gui(GLFWwindow* window);
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  // `scale` is that of text and all else, in pixels of the picture.
  void begin_frame(float scale);
  void end_frame();  // draws into the window
  [[nodiscard]] bool wants_mouse() const;
  [[nodiscard]] bool wants_text() const;
  // Where the pointer is in the window, in pixels of the picture; empty over the panel and outside.
  [[nodiscard]] std::optional<Point> pointer() const;
  [[nodiscard]] double pixels() const;  // of the picture to a unit of the window

 private:
  void set_scale(float scale);
  float scale_ = 0;
};

}  // namespace lodestone::viewer
