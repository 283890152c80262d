// Cuts of solids on gl (render/effects/cut_face.h): fronts less backs, added up by blending at every sample.
#pragma once

#include <functional>

#include "render/backends/gl/device/target.h"
#include "render/backends/gl/scene/commands.h"
#include "render/effects/cut_face.h"

namespace lodestone {

class GlCuts {
 public:
  GlCuts(ImageSize size, int samples);
  [[nodiscard]] bool fits(ImageSize size, int samples) const { return size == size_ && samples == samples_; }
  // Into colour and depth of the target, where nothing is nearer. The faces are those of the frame.
  void draw(const Frame& frame, const std::vector<effects::CutFace>& faces, const GlScene& scene, GlStream& stream,
            const std::function<void(const GlPipeline&)>& use, const GlTarget& target);

 private:
  void count(const Frame& frame, const effects::CutFace& face, const GlScene& scene, GlStream& stream,
             const std::function<void(const GlPipeline&)>& use);

  ImageSize size_;
  int samples_;
  GlTexture windings_;
  GlFramebuffer framebuffer_;
  GlProgram fill_;
  GlVertexArray nothing_;
  GlCommands commands_;
};

}  // namespace lodestone
