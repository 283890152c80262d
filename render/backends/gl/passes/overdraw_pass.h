// The overdraw of gl (render/effects/overdraw.h): triangles counted by blending, at pixel centres.
#pragma once

#include <functional>

#include "render/backends/gl/device/target.h"
#include "render/backends/gl/scene/commands.h"

namespace lodestone {

class GlOverdraw {
 public:
  explicit GlOverdraw(ImageSize size);
  [[nodiscard]] ImageSize size() const { return size_; }
  // Colour and depth of the target from the commands. Returns how many samples the triangles cover.
  std::uint64_t draw(const GlCommands& commands, const GlScene& scene,
                     const std::function<void(const GlPipeline&)>& use, const GlTarget& target);

 private:
  ImageSize size_;
  GlTexture counts_, depth_;
  GlFramebuffer framebuffer_;
  GlProgram colours_;
  GlVertexArray nothing_;
  GlSampleCounter covered_;
};

}  // namespace lodestone
