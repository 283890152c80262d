// Stage 3: visibility and shading of one tile.
//
// First the depth test leaves in each pixel the nearest triangle and its barycentric coordinates; then each covered
// pixel is shaded once. The picture depends on the order of the triangles alone: tiles do not share pixels.
#pragma once

#include <array>
#include <span>

#include "render/backends/soft/raster_types.h"
#include "render/renderer.h"

namespace lodestone::soft {

// Working memory of one worker: what is seen in the pixels of a tile.
struct TileScratch {
  static constexpr std::size_t pixels = std::size_t{tile_size} * tile_size;
  std::array<float, pixels> depth;
  std::array<const TriangleRef*, pixels> triangle;  // null: background
  std::array<float, pixels> share_b, share_c;       // barycentric coordinates of the second and third corner
};

// Draws the tile's triangles of all batches, in order, into the image, which has the grid's size and both planes.
void draw_tile(const Frame& frame, const TileGrid& grid, std::size_t tile, std::span<const Batch> batches,
               std::span<const WindowVertex> vertices, TileScratch& scratch, Image& image);

}  // namespace lodestone::soft
