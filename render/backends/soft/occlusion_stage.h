// Occlusion culling of a picture (render/culling/occlusion.h): which parts of cells are drawn first, and which of the
// others then.
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
  // Begins a frame. Of all parts those that were in sight in the last one, or nothing is known of.
  [[nodiscard]] std::span<const PartToDraw> first(const Frame& frame, const DrawnCells& drawn,
                                                  std::span<const PartToDraw> all);
  // The depth of a finished tile. Tiles may be taken at once.
  template <int Samples>
  void take(const TileBuffer<Samples>& tile, PixelRect rect);
  // The others that those drawn so far do not hide.
  [[nodiscard]] std::span<const PartToDraw> second() { return to_draw(culling_.second()); }
  // Notes what the finished picture hides, for the next frame.
  void finish() { culling_.finish(); }

  // That were not drawn.
  [[nodiscard]] std::size_t hidden_cells() const { return culling_.hidden_cells(); }
  [[nodiscard]] std::uint64_t hidden_triangles() const { return culling_.hidden_triangles(); }

 private:
  [[nodiscard]] std::span<const PartToDraw> to_draw(std::span<const VisiblePart> parts);

  OcclusionCulling culling_;
  std::vector<VisiblePart> visible_;
  std::vector<PartToDraw> to_draw_;
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
