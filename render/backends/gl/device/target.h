// The offscreen picture: RGBA8 and 32-bit float depth, one or several samples a pixel.
#pragma once

#include <optional>

#include "render/backends/gl/device/object.h"
#include "render/frame/renderer.h"

namespace lodestone {

// A texture of one value for each sample of a picture.
[[nodiscard]] GlTexture make_plane(GLenum format, ImageSize size, int samples);

class GlTarget {
 public:
  // Throws ResourceError when out of memory.
  GlTarget(ImageSize size, int samples);

  [[nodiscard]] ImageSize size() const { return size_; }
  [[nodiscard]] int samples() const { return samples_; }
  void bind() const;                   // for drawing, viewport included
  void clear(Vec3f background) const;  // and to depth 1
  void average() const;                // after drawing: the samples of each pixel; depth becomes that of one of them
  void copy_to(GLuint framebuffer) const;  // colours, the upper row first
  [[nodiscard]] Image read() const;
  // Textures: depth as drawn, with all samples; and the averaged picture, with the framebuffer that draws into it.
  [[nodiscard]] GLuint drawn_depth() const { return drawn_.depth.name(); }
  [[nodiscard]] GLuint colour() const { return result().colour.name(); }
  [[nodiscard]] GLuint depth() const { return result().depth.name(); }
  void bind_result() const;

 private:
  struct Planes {
    GlTexture colour, depth;
    GlFramebuffer framebuffer;
    Planes(ImageSize size, int samples);
  };
  [[nodiscard]] const Planes& result() const { return averaged_ ? *averaged_ : drawn_; }

  ImageSize size_;
  int samples_;
  Planes drawn_;
  std::optional<Planes> averaged_;  // with several samples
};

}  // namespace lodestone
