#include "render/backends/soft/shadow_map.h"

#include <algorithm>

namespace lodestone::soft {

// A picture of the casters alone, whose surfaces need no shading: only how opaque they are counts.
void ShadowMap::see_from_light(const Frame& frame) {
  const int texels = frame.settings.lighting.directional.shadow_texels;
  frame_ = frame;
  frame_.size = {texels, texels};
  frame_.samples = 1;
  std::erase_if(frame_.models, [](const ModelFrame& model) { return model.casters == nullptr; });
  eyes_.clear();
  for (ModelFrame& model : frame_.models) {
    model.view_projection = model.light_projection;
    model.selection = model.casters;
    model.effects = model.effects & EffectSet{Effect::geomorph};
    eyes_.push_back(eye_of(model.view_projection));
  }
}

void ShadowMap::draw(const Frame& frame, const SurfaceTextures& textures) {
  see_from_light(frame);
  GeometryPass opaque = opaque_pass(frame_, textures), layered = layers_pass(frame_, textures);
  opaque.both_sides = layered.both_sides = true;
  geometry_.run(opaque, 1);
  has_layers_ = !layered.models.empty();
  if (has_layers_) {
    if (!layers_) layers_.emplace(scheduler_, kernels_);
    layers_->run(layered, 1);
  }
  const TileGrid grid(frame_.size);
  const std::size_t texels = static_cast<std::size_t>(frame_.size.width) * static_cast<std::size_t>(frame_.size.height);
  depth_.resize(texels);
  if (has_layers_) first_.resize(texels), through_.resize(texels);
  scheduler_.for_chunks(grid.count(), 1, [&](ChunkRange range) {
    Workplace& here = workers_[static_cast<std::size_t>(scheduler_.worker_index())];
    for (std::size_t k = range.begin; k < range.end; ++k) draw_tile_of_map(k, textures, here);
  });
}

void ShadowMap::draw_tile_of_map(std::size_t number, const SurfaceTextures& textures, Workplace& here) {
  const PixelRect rect = TileGrid(frame_.size).rect(number);
  if (!here.tile) here.tile = std::make_unique<TileBuffer<1>>();
  TileBuffer<1>& tile = *here.tile;
  draw_tile<1>(kernels_, geometry_.workers(), number, rect, tile);
  if (!has_layers_) return copy(tile.depth.data(), rect, depth_);

  if (!here.layers) here.layers = std::make_unique<TileLayers<1>>();
  const Viewport viewport(frame_.size);
  const DrawnCells drawn = layers_->drawn();
  ResolveJob job{
      {&frame_, viewport.half_width(), viewport.half_height(), eyes_.data(), &textures}, &viewport, &drawn, rect};
  job.work = &here.work;
  const LayerLight* light = here.layers->draw(kernels_, layers_->workers(), number, tile, job);
  static constexpr auto nothing = [] {
    std::array<float, TileBuffer<1>::samples> ones{};
    ones.fill(1);
    return ones;
  }();
  copy(light ? light->depth : tile.depth.data(), rect, depth_);
  copy(light ? light->first : nothing.data(), rect, first_);
  copy(light ? light->through : nothing.data(), rect, through_);
}

void ShadowMap::copy(const float* plane, PixelRect rect, std::vector<float>& to) const {
  for (int y = rect.y0; y < rect.y1; ++y)
    std::copy_n(plane + static_cast<std::size_t>(y - rect.y0) * tile_size, rect.x1 - rect.x0,
                &to[static_cast<std::size_t>(y) * static_cast<std::size_t>(frame_.size.width) +
                    static_cast<std::size_t>(rect.x0)]);
}

}  // namespace lodestone::soft
