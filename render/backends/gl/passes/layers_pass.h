// Transparent surfaces of gl (render/effects/transparency.h): each pixel's fragments in a list (yang2010), sorted and
// put over the picture by a program that visits every pixel, or with several samples every sample, once.
#pragma once

#include <cstdint>
#include <functional>

#include "render/backends/gl/device/target.h"
#include "render/backends/gl/scene/commands.h"

namespace lodestone {

// Storage blocks of the lists.
inline constexpr GLuint layer_heads_block = 8, layer_nodes_block = 9;

class GlLayers {
 public:
  // No list holds more than `max_bytes` in all. Throws UnsupportedError where the device binds too few storage blocks.
  GlLayers(ImageSize size, int samples, std::size_t max_bytes);
  [[nodiscard]] bool fits(ImageSize size, int samples) const { return size_ == size && samples_ == samples; }
  // Puts them over the target. The picture's alpha becomes the share that they let through if `keeps_through`. Throws
  // ResourceError when the lists do not fit.
  void draw(const Frame& frame, const GlScene& scene, GlStream& stream,
            const std::function<void(const GlPipeline&)>& use, const GlTarget& target, bool keeps_through);
  [[nodiscard]] const GlCommands& commands() const { return commands_; }
  [[nodiscard]] std::uint64_t fragments() const { return fragments_; }

 private:
  void reserve(std::uint64_t nodes);
  void collect(const GlScene& scene, const std::function<void(const GlPipeline&)>& use);

  ImageSize size_;
  int samples_;
  std::size_t node_bytes_, max_bytes_;
  GlBuffer heads_, nodes_;
  GlProgram over_;
  GlVertexArray nothing_;
  GlCommands commands_;
  std::uint64_t room_ = 0, fragments_ = 0;
};

}  // namespace lodestone
