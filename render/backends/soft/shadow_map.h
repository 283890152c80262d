// The map of the directional light (render/effects/shadow.h): depths of the casters, by the stages that draw the
// picture.
#pragma once

#include <memory>
#include <vector>

#include "render/backends/soft/geometry_stage.h"
#include "render/backends/soft/tile_buffer.h"

namespace lodestone::soft {

class ShadowMap {
 public:
  ShadowMap(Scheduler& scheduler, const Kernels& kernels)
      : scheduler_(scheduler),
        kernels_(kernels),
        geometry_(scheduler, kernels),
        tiles_(static_cast<std::size_t>(scheduler.workers())) {}

  void draw(const Frame& frame);
  [[nodiscard]] ShadowView view() const { return {depth_.data(), texels_}; }
  [[nodiscard]] std::uint64_t triangles() const { return geometry_.triangles(); }

 private:
  Scheduler& scheduler_;
  const Kernels& kernels_;
  GeometryStage geometry_;
  std::vector<std::unique_ptr<TileBuffer<1>>> tiles_;  // one for each worker, made when first used
  std::vector<float> depth_;
  int texels_ = 0;
};

}  // namespace lodestone::soft
