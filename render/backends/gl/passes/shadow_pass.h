// The shadow map of gl (render/effects/shadow.h): depth seen from the light, and what layers let through of it.
#pragma once

#include <functional>
#include <optional>

#include "render/backends/gl/scene/commands.h"

namespace lodestone {

inline constexpr GLuint shadow_unit = 8, shadow_first_unit = 12, shadow_through_unit = 13;  // texture units

class GlShadow {
 public:
  explicit GlShadow(int texels);
  [[nodiscard]] int texels() const { return texels_; }
  // Binds the map for the programs that read it, too.
  void draw(const Frame& frame, const GlScene& scene, GlStream& stream,
            const std::function<void(const GlPipeline&)>& use);
  [[nodiscard]] std::uint64_t triangles() const { return triangles_; }

 private:
  // The casters that are not opaque: depth of the first, and the share that all of them let through.
  struct Layers {
    GlTexture first, through;
    GlFramebuffer framebuffer;
    Layers(int texels, const GlTexture& depth);
  };
  void draw_layers(const GlScene& scene, const std::function<void(const GlPipeline&)>& use);

  int texels_;
  GlTexture depth_, no_layers_;
  GlFramebuffer framebuffer_;
  std::optional<Layers> layers_;  // made when first used
  GlCommands commands_;
  std::uint64_t triangles_ = 0;
};

}  // namespace lodestone
