#include "render/backends/soft/occlusion_stage.h"

#include <algorithm>

namespace lodestone::soft {

std::span<const PartToDraw> OcclusionStage::first(const Frame& frame, const DrawnCells& drawn,
                                                  std::span<const PartToDraw> all) {
  visible_.clear();
  for (const PartToDraw& part : all) {
    const DrawnCell& cell = drawn.cells[part.cell];
    const auto model = static_cast<std::uint32_t>(cell.model - frame.models.data());
    visible_.push_back({model, part.cell, cell.cell, cell.level, part.ranges});
  }
  return to_draw(culling_.first(frame, visible_));
}

std::span<const PartToDraw> OcclusionStage::to_draw(std::span<const VisiblePart> parts) {
  to_draw_.clear();
  for (const VisiblePart& part : parts) to_draw_.push_back({part.number, part.ranges});
  return to_draw_;
}

template <int Samples>
void OcclusionStage::take(const TileBuffer<Samples>& tile, PixelRect rect) {
  constexpr int block = DepthPyramid::block_size;
  static_assert(tile_size % block == 0);
  DepthPyramid& pyramid = culling_.pyramid();
  const std::span<float> blocks = pyramid.blocks();
  for (int y = rect.y0; y < rect.y1; y += block)
    for (int x = rect.x0; x < rect.x1; x += block) {
      const int columns = std::min(block, rect.x1 - x), rows = std::min(block, rect.y1 - y);
      float farthest = 0;
      for (std::size_t s = 0; s < static_cast<std::size_t>(Samples); ++s)
        for (int row = 0; row < rows; ++row) {
          const float* depth =
              &tile.depth[s * tile_pixels + static_cast<std::size_t>((y - rect.y0 + row) * tile_size + x - rect.x0)];
          farthest = std::max(farthest, *std::max_element(depth, depth + columns));
        }
      blocks[static_cast<std::size_t>((y / block) * pyramid.columns() + x / block)] = farthest;
    }
}

void TouchedTiles::mark(std::span<const GeometryStage::Workplace> workers, std::size_t tiles) {
  tiles_ = tiles;
  ends_.clear();
  for (const GeometryStage::Workplace& w : workers)
    for (std::size_t t = 0; t < tiles; ++t) ends_.push_back(ends_of(w, t));
}

std::vector<std::uint32_t> TouchedTiles::since_mark(std::span<const GeometryStage::Workplace> workers) const {
  std::vector<std::uint32_t> touched;
  for (std::uint32_t t = 0; t < tiles_; ++t)
    for (std::size_t w = 0; w < workers.size(); ++w)
      if (ends_of(workers[w], t) != ends_[w * tiles_ + t]) {
        touched.push_back(t);
        break;
      }
  return touched;
}

template void OcclusionStage::take<1>(const TileBuffer<1>&, PixelRect);
template void OcclusionStage::take<4>(const TileBuffer<4>&, PixelRect);

}  // namespace lodestone::soft
