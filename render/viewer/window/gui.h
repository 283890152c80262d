// Dear ImGui in the viewer's window: its frame, and whose the mouse and the keyboard are.
#pragma once

struct GLFWwindow;

namespace lodestone::viewer {

class Gui {
 public:
  // The window's callbacks must be installed before: they are called first. `scale` is that of text and all else.
  // Nothing is written to disk.
  Gui(GLFWwindow* window, float scale);
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  void begin_frame();
  void end_frame();  // draws into the window
  [[nodiscard]] bool wants_mouse() const;
  [[nodiscard]] bool wants_text() const;
  [[nodiscard]] double pixels() const;  // of the picture to a unit of the window
};

}  // namespace lodestone::viewer
