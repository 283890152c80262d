// Occlusion culling of a picture (render/culling/occlusion.h): which cells are drawn first, and which of the others
// then.
//
//     first()  -> geometry and tiles -> second() -> geometry, and the tiles that it touched once more -> finish()
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/backends/soft/geometry_stage.h"
#include "render/backends/soft/tile_buffer.h"
#include "render/culling/occlusion.h"

namespace lodestone::soft {

class OcclusionStage {
 public:
  // Begins a frame. The cells, as numbers in `drawn`, that were in sight in the last one, or nothing is known of.
  [[nodiscard]] std::span<const std::uint32_t> first(const Frame& frame, const DrawnCells& drawn);
  // The depth of a finished tile. Tiles may be taken at once.
  template <int Samples>
  void take(const TileBuffer<Samples>& tile, PixelRect rect);
  // The other cells that those drawn so far do not hide.
  [[nodiscard]] std::span<const std::uint32_t> second(const Frame& frame, const DrawnCells& drawn);
  // Notes the cells that the finished picture hides, for the next frame.
  void finish(const Frame& frame, const DrawnCells& drawn);

  // That were not drawn.
  [[nodiscard]] std::size_t hidden_cells() const { return hidden_; }
  [[nodiscard]] std::uint64_t hidden_triangles() const { return hidden_triangles_; }

 private:
  [[nodiscard]] static std::size_t model_of(const Frame& frame, const DrawnCell& cell) {
    return static_cast<std::size_t>(cell.model - frame.models.data());
  }
  [[nodiscard]] bool hides(const Frame& frame, const DrawnCell& cell) {
    return culling_.hides(model_of(frame, cell), cell.cell, cell.level);
  }

  OcclusionCulling culling_;
  std::vector<std::uint32_t> first_, waiting_, second_;
  std::size_t hidden_ = 0;
  std::uint64_t hidden_triangles_ = 0;
};

// Which tiles have got something since the last call.
class TouchedTiles {
 public:
  void mark(std::span<const GeometryStage::Workplace> workers, std::size_t tiles);
  // In order.
  [[nodiscard]] std::vector<std::uint32_t> since_mark(std::span<const GeometryStage::Workplace> workers) const;

 private:
  struct Ends {
    const Fragment* fragments;
    const TriangleRecord* triangles;
    friend bool operator==(const Ends&, const Ends&) = default;
  };
  [[nodiscard]] static Ends ends_of(const GeometryStage::Workplace& worker, std::size_t tile) {
    return {worker.bins.fragments.end_of(tile), worker.bins.triangles.end_of(tile)};
  }
  std::vector<Ends> ends_;  // by worker, then tile
  std::size_t tiles_ = 0;
};

}  // namespace lodestone::soft
