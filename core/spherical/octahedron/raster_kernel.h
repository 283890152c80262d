// The inner loops of sphere_raster.h, compiled for AVX2 and for any processor, equal bytes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/instruction_set.h"
#include "core/math/vec3.h"
#include "core/spherical/octahedron/octahedral_map.h"

namespace lodestone::spherical {

// n x n samples, n at most 32768. In cells: at the centres of n x n squares; on_sides: the first and last ones on the
// sides (n >= 2).
struct SampleGrid {
  enum class Placing : std::uint8_t { in_cells, on_sides };
  std::uint32_t n = 0;
  Placing placing = Placing::in_cells;

  [[nodiscard]] double coordinate(std::uint32_t i) const {
    return placing == Placing::in_cells ? (i + 0.5) / n : static_cast<double>(i) / (n - 1);
  }
  [[nodiscard]] SquarePoint place(std::uint32_t x, std::uint32_t y) const { return {coordinate(x), coordinate(y)}; }
};

inline constexpr std::uint32_t no_triangle = 0xFFFF'FFFFu;

// The samples [x, x + width) x [y, y + height), row by row, `side` of them reserved for a row.
struct SampleTile {
  static constexpr std::uint32_t side = 64;  // the greatest width and height; a multiple of 4
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
  std::array<std::vector<double>, 3> ray;    // components of vectors along the directions, of any length
  std::vector<std::uint32_t> triangle;       // no_triangle where the mesh leaves a hole
  std::array<std::vector<float>, 3> weight;  // barycentric, of sum 1; nothing without a triangle
};

// Samples [left, right) x [top, bottom) of a tile.
struct TileWindow {
  std::uint32_t left = 0, right = 0, top = 0, bottom = 0;
};

struct RasterKernel {
  // Sets the rays of a tile from its place; memory is reused. direction_of() without its division by the length.
  void (*set_rays)(const SampleGrid& grid, SampleTile& tile);
  // Gives the samples of the window that are within the three planes, and have no triangle yet, to the triangle. Its
  // normals are those of the planes through the centre and the edge opposite to each corner.
  void (*cover)(std::uint32_t triangle, const std::array<Vec3d, 3>& normals, const TileWindow& window,
                SampleTile& tile);
};
// The build for AVX2 is null where the compiler does not know it.
extern const RasterKernel *const plain_raster_kernel, *const avx2_raster_kernel;

}  // namespace lodestone::spherical
