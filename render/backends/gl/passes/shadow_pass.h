// The shadow map of gl (render/effects/shadow.h): depth seen from the light.
#pragma once

#include <functional>

#include "render/backends/gl/scene/commands.h"

namespace lodestone {

inline constexpr GLuint shadow_unit = 8;  // texture unit

class GlShadow {
 public:
  explicit GlShadow(int texels);
  [[nodiscard]] int texels() const { return texels_; }
  // Binds the map for the programs that read it, too.
  void draw(const Frame& frame, const GlScene& scene, GlStream& stream,
            const std::function<void(const GlPipeline&)>& use);
  [[nodiscard]] std::uint64_t triangles() const { return commands_.triangles(); }

 private:
  int texels_;
  GlTexture depth_;
  GlFramebuffer framebuffer_;
  GlCommands commands_;
};

}  // namespace lodestone
