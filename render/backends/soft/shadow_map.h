// The map of the directional light (render/effects/shadow.h): depths of the casters, and what those that are not opaque
// let through, by the stages that draw the picture.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "render/backends/soft/geometry_stage.h"
#include "render/backends/soft/layers.h"
#include "render/backends/soft/tile_buffer.h"

namespace lodestone::soft {

class ShadowMap {
 public:
  ShadowMap(Scheduler& scheduler, const Kernels& kernels)
      : scheduler_(scheduler),
        kernels_(kernels),
        geometry_(scheduler, kernels),
        workers_(static_cast<std::size_t>(scheduler.workers())) {}

  void draw(const Frame& frame, const SurfaceTextures& textures);
  [[nodiscard]] ShadowView view() const {
    return {depth_.data(), frame_.size.width, has_layers_ ? first_.data() : nullptr,
            has_layers_ ? through_.data() : nullptr};
  }
  [[nodiscard]] std::uint64_t triangles() const {
    return geometry_.triangles() + (has_layers_ ? layers_->triangles() : std::uint64_t{0});
  }

 private:
  // One for each worker; made when first used.
  struct Workplace {
    std::unique_ptr<TileBuffer<1>> tile;
    std::unique_ptr<TileLayers<1>> layers;
    WorkCounts work{};  // of no interest
  };
  void see_from_light(const Frame& frame);
  void draw_tile_of_map(std::size_t number, const SurfaceTextures& textures, Workplace& here);
  void copy(const float* plane, PixelRect rect, std::vector<float>& to) const;

  Scheduler& scheduler_;
  const Kernels& kernels_;
  GeometryStage geometry_;
  std::optional<GeometryStage> layers_;  // made when first used
  bool has_layers_ = false;              // this frame
  std::vector<Workplace> workers_;
  Frame frame_;            // as the light sees it
  std::vector<Eye> eyes_;  // of its models
  std::vector<float> depth_, first_, through_;
};

}  // namespace lodestone::soft
