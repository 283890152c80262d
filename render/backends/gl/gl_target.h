// The offscreen picture: RGBA8 and 32-bit float depth.
#pragma once

#include "render/backends/gl/gl_object.h"
#include "render/renderer.h"

namespace lodestone {

class GlTarget {
 public:
  // Throws InputError for a size below 1 or beyond max_size, ResourceError when out of memory.
  GlTarget(ImageSize size, int max_size);

  [[nodiscard]] ImageSize size() const { return size_; }
  void bind() const;   // for drawing, viewport included
  void clear() const;  // to the background of render/shading.h and depth 1
  [[nodiscard]] Image read() const;

 private:
  ImageSize size_;
  GlRenderbuffer colour_, depth_;
  GlFramebuffer framebuffer_;
};

}  // namespace lodestone
