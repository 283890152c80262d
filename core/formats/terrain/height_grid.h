// Surfaces over a regular grid of heights.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Posts in rows from north to south, each from west to east. x runs east, y north and z up, all from the south-west
// post unless an origin says otherwise.
struct HeightGrid {
  std::size_t width = 0, height = 0;    // posts, at least 2 each
  double spacing_x = 1, spacing_y = 1;  // between posts, in the unit of the heights
  double origin_x = 0, origin_y = 0;    // of the south-west post
  std::vector<float> heights;           // width * height of them; NaN: void
  [[nodiscard]] std::size_t posts() const { return width * height; }
};

// Interpolates every void post from the nearest known posts to the west, east, north and south, each weighted by the
// inverse of its distance, with the weights along an axis measured in posts of that axis: linear across a gap in a row
// or column, and exact on a plane where all four exist. Posts that have none (their row and column are void) follow in
// further passes. Returns how many were filled: none when every post is void. O(posts) time per pass, at most three
// passes; 16 bytes per post beside the grid.
std::uint64_t fill_voids(HeightGrid& grid);

// Two triangles for each quad of four known posts, counter-clockwise seen from above, the diagonal from south-west to
// north-east; a quad with a void corner stays open. Posts that no triangle uses are no vertices. Row by row from the
// south, west first. Throws ResourceError, naming `name`, for more posts than 32-bit indices reach.
[[nodiscard]] RawMesh triangulate(const HeightGrid& grid, const std::string& name = {});

}  // namespace lodestone
