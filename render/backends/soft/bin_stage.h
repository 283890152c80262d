// Stage 2: triangles of a batch of cells, clipped where they must be and sorted by the tiles that they touch.
#pragma once

#include <span>

#include "render/backends/soft/raster_types.h"
#include "render/backends/soft/vertex_stage.h"

namespace lodestone::soft {

// A visible cell and where its vertices start in the frame's.
struct DrawnCell {
  SelectedCell selected;
  std::uint32_t first_vertex = 0;
};

// Working memory of one worker.
struct BinScratch {
  struct Entry {
    TriangleRef triangle;
    std::uint32_t tile;
  };
  std::vector<Entry> entries;
};

// Bins the triangles of `cells`, which are batch number `index`, in their order. Triangles that cover no pixel centre
// of the picture are left out.
void bin_batch(const Frame& frame, const Viewport& viewport, const TileGrid& grid, std::span<const DrawnCell> cells,
               std::span<const WindowVertex> vertices, std::uint32_t index, BinScratch& scratch, Batch& out);

}  // namespace lodestone::soft
