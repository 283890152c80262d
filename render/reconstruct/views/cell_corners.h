// The cells of a view mesh around the pixel in which they meet.
#pragma once

#include <cstddef>
#include <cstdint>

#include "render/reconstruct/views/view_mesh.h"

namespace lodestone {

struct CellsAround {
  std::uint8_t p = 0, q = 0, r = 0, s = 0;  // the cells in which the pixel is that corner
};

[[nodiscard]] inline CellsAround cells_around(const PixelArray<std::uint8_t>& cells, std::size_t i, std::size_t width) {
  return {cells[i], i >= 1 ? cells[i - 1] : std::uint8_t{0}, i >= width ? cells[i - width] : std::uint8_t{0},
          i >= width + 1 ? cells[i - width - 1] : std::uint8_t{0}};
}

// True if the pixel is a corner of a triangle.
[[nodiscard]] inline bool is_vertex(const CellsAround& a) {
  return (a.p & (cell_prs | cell_psq | cell_prq)) || (a.q & (cell_psq | cell_prq | cell_rsq)) ||
         (a.r & (cell_prs | cell_prq | cell_rsq)) || (a.s & (cell_prs | cell_psq | cell_rsq));
}

}  // namespace lodestone
