// What is seen in the samples of a tile: the visibility buffer (Burns and Hunt 2013) with its depth.
#pragma once

#include <algorithm>
#include <array>

#include "render/backends/soft/raster_types.h"

namespace lodestone::soft {

// The nearest triangle wins, of equally near ones the one that is drawn first. That is a minimum: the order in which
// triangles arrive does not matter.
template <int Samples>
struct TileBuffer {
  static constexpr std::size_t samples = tile_pixels * static_cast<std::size_t>(Samples);
  static constexpr int block_size = 8, blocks_per_row = tile_size / block_size;

  // Sample s of all pixels, row by row, then the next sample. Depth 1: background.
  alignas(64) std::array<float, samples> depth;
  alignas(64) std::array<TriangleNumber, samples> triangle;
  // Hierarchical depth (Greene et al. 1993), one level: no sample of a block of 8x8 pixels is farther.
  std::array<float, blocks_per_row * blocks_per_row> farthest;
  std::array<std::uint8_t, blocks_per_row * blocks_per_row> changes;  // since `farthest` was computed

  void clear() {
    depth.fill(1);
    triangle.fill(0);
    farthest.fill(1);
    changes.fill(0);
  }

  void put(std::uint32_t sample, float z, TriangleNumber number) {
    const float old_z = depth[sample];
    const TriangleNumber old = triangle[sample];
    const bool wins = (z < old_z) | ((z == old_z) & (number < old));
    depth[sample] = wins ? z : old_z;
    triangle[sample] = wins ? number : old;
  }
};

}  // namespace lodestone::soft
