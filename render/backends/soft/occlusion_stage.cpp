#include "render/backends/soft/occlusion_stage.h"

#include <algorithm>

namespace lodestone::soft {

std::span<const std::uint32_t> OcclusionStage::first(const Frame& frame, const DrawnCells& drawn) {
  culling_.begin(frame);
  first_.clear();
  waiting_.clear();
  hidden_ = hidden_triangles_ = 0;
  for (std::uint32_t k = 0; k < drawn.cells.size(); ++k) {
    const bool waits = culling_.waits(model_of(frame, drawn.cells[k]), drawn.cells[k].cell);
    (waits ? waiting_ : first_).push_back(k);
  }
  return first_;
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

// Cells that are hidden now remain so: later tiles are only nearer.
std::span<const std::uint32_t> OcclusionStage::second(const Frame& frame, const DrawnCells& drawn) {
  culling_.pyramid().build();
  second_.clear();
  for (const std::uint32_t k : waiting_) {
    const DrawnCell& cell = drawn.cells[k];
    if (hides(frame, cell)) {
      ++hidden_;
      hidden_triangles_ += drawn_triangles(*cell.own, cell.ranges);
    } else {
      second_.push_back(k);
    }
  }
  return second_;
}

void OcclusionStage::finish(const Frame& frame, const DrawnCells& drawn) {
  if (!second_.empty()) culling_.pyramid().build();
  for (const auto* cells : {&first_, &second_})
    for (const std::uint32_t k : *cells) (void)hides(frame, drawn.cells[k]);
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
