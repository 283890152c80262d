// Ambient occlusion of gl (render/effects/ambient_occlusion.h): a program over the finished picture.
#pragma once

#include "render/backends/gl/device/target.h"

namespace lodestone {

class GlOcclusion {
 public:
  GlOcclusion();
  // Darkens the averaged picture; alpha tells what layers let through, and is 1 afterwards.
  void draw(const Frame& frame, const GlTarget& target);

 private:
  GlProgram program_;
  GlVertexArray nothing_;
};

}  // namespace lodestone
