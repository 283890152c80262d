#include "render/backends/soft/shadow_map.h"

#include <algorithm>

namespace lodestone::soft {

void ShadowMap::draw(const Frame& frame) {
  texels_ = frame.settings.lighting.directional.shadow_texels;
  depth_.resize(static_cast<std::size_t>(texels_) * static_cast<std::size_t>(texels_));
  GeometryPass pass;
  pass.projection = &ModelFrame::light_projection;
  pass.selection = &ModelFrame::casters;
  pass.size = {texels_, texels_};
  for (const ModelFrame& model : frame.models)
    if (model.casters) pass.models.push_back({&model});
  geometry_.run(pass, 1);

  const TileGrid grid(pass.size);
  scheduler_.for_chunks(grid.count(), 1, [&](ChunkRange range) {
    auto& tile = tiles_[static_cast<std::size_t>(scheduler_.worker_index())];
    if (!tile) tile = std::make_unique<TileBuffer<1>>();
    for (std::size_t k = range.begin; k < range.end; ++k) {
      const PixelRect rect = grid.rect(k);
      draw_tile<1>(kernels_, geometry_.workers(), k, rect, *tile);
      for (int y = rect.y0; y < rect.y1; ++y) {
        const float* row = &tile->depth[static_cast<std::size_t>(y - rect.y0) * tile_size];
        std::copy(row, row + (rect.x1 - rect.x0),
                  &depth_[static_cast<std::size_t>(y) * static_cast<std::size_t>(texels_) +
                          static_cast<std::size_t>(rect.x0)]);
      }
    }
  });
}

}  // namespace lodestone::soft
