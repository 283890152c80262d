// What a reader of mesh files is asked for beside the file itself.
#pragma once

#include <bit>
#include <cstddef>
#include <optional>

#include "core/files/scalar.h"

namespace lodestone {

// A file of nothing but heights, row by row from the north, each row from the west.
struct RawGridFormat {
  std::size_t width = 0, height = 0;  // posts, at least 2 each
  ScalarType type = ScalarType::int16;
  std::endian byte_order = std::endian::little;
  double spacing = 1;  // between posts, in the unit of the heights
};

struct ReadConfig {
  bool attributes = true;                      // false: positions and triangles alone, which is faster and smaller
  bool fill_voids = false;                     // of height grids; false: they stay open
  std::optional<RawGridFormat> raw_grid = {};  // the file is of this format, whatever its name
};

}  // namespace lodestone
