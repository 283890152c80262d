// A picture in the window's OpenGL context, for the user interface to put on the screen. Plain OpenGL 3: it also works
// in windows without 4.5.
#pragma once

#include "render/frame/image.h"
#include "render/viewer/controls/layout.h"

namespace lodestone {
class GlRenderer;
}

namespace lodestone::viewer {

// The context must be current in every call.
class Picture {
 public:
  Picture();
  ~Picture();
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  void set(const Image& image);
  // Copies the last picture of a renderer of the same context, on the device.
  void copy_from(GlRenderer& renderer, ImageSize size);

  [[nodiscard]] unsigned texture() const { return texture_; }  // the first row is the upper one
  [[nodiscard]] ImageSize size() const { return size_; }
  // Shown in a rectangle of this size: pixel by pixel where it fits, smoothly otherwise.
  void fit(ImageSize shown) const;

 private:
  void resize(ImageSize size);

  unsigned texture_ = 0, framebuffer_ = 0;
  ImageSize size_{0, 0};
};

// A part of what was drawn into a window of this size since the last swap; rows from the top, no depth.
[[nodiscard]] Image read_window(ImageSize window, Rect part);
// Before the user interface is drawn into the window.
void clear_window(ImageSize size);

}  // namespace lodestone::viewer
