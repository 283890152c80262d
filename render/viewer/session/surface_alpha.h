// How opaque a surface is at a point of a picture, as the picture has it (render/effects/transparency.h): masked and
// blended materials, the alpha of their textures and vertices, and the opacity of the model.
#pragma once

#include <array>
#include <span>

#include "parallel/scheduler/scheduler.h"
#include "render/textures/surface_textures.h"

namespace lodestone::viewer {

// Shares of the second and the third corner of a triangle; that of the first is the rest.
struct CornerShares {
  double b = 0, c = 0;
};

// A triangle as it is drawn, and where it is met.
struct MetTriangle {
  CellId cell;
  int level = 0;
  bool morphing = false;
  std::array<std::uint32_t, 3> corners{};  // in the cell
  CornerShares here, right, below;         // at the point, and one pixel beside it in its plane
};

class SurfaceAlpha {
 public:
  // Those that are uploaded to the renderer; they must outlive it.
  void set_models(std::span<const Hierarchy* const> models) { textures_.set_models(models); }
  // Decodes the textures whose alpha the frame shows, each once.
  void prepare(const Frame& frame, Scheduler& scheduler);
  // In [0, 1]. The frame is one that was prepared.
  [[nodiscard]] float opacity(const Frame& frame, const ModelFrame& model, const MetTriangle& met) const;

 private:
  [[nodiscard]] double alpha_of_texture(const ModelFrame& model, const SurfaceTexture& texture,
                                        const MetTriangle& met) const;

  SurfaceTextures textures_;
};

}  // namespace lodestone::viewer
