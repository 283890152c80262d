// Requests of a caller to a reader of mesh files, and promises of all readers. core/formats/mesh_file.h chooses among
// the readers; the header of each format (core/formats/ply/ply.h, ...) says what it reads.
//
// A reader begins at the current offset and ends with the mesh. It allocates no memory for a declared count that the
// remaining bytes cannot hold, and checks every index against the number of vertices. Coordinates that are not finite
// are read as they are. Polygons are cut within themselves (core/mesh/polygons.h); faces of fewer than three corners
// are dropped and counted. Anything that ReadConfig does not ask for is skipped. An error in attributes or materials
// alone, such as a missing image, is a warning in the mesh.
//
// All readers throw InputError for a malformed or truncated file, with the line or the element and byte offset;
// FileError when the disk fails; UnsupportedError for variants of a format that are not read; ResourceError for more
// vertices than 32-bit indices reach.
#pragma once

#include <bit>
#include <cstddef>
#include <functional>
#include <optional>

#include "core/files/scalar_type.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// A file that holds heights alone, row by row from the north, each row from the west.
struct RawGridFormat {
  std::size_t width = 0, height = 0;  // posts, at least 2 each
  ScalarType type = ScalarType::int16;
  std::endian byte_order = std::endian::little;
  double spacing = 1;  // between posts, in the unit of the heights
};

struct ReadConfig {
  bool attributes = true;  // false: positions and triangles alone, which is faster and smaller
  // Files that a model names are read wherever they are; false: within its folder alone.
  bool allow_outside = false;
  bool fill_voids = false;                     // of height grids; false: voids remain open
  std::optional<RawGridFormat> raw_grid = {};  // the file has this format if its extension names no other
  std::optional<UpAxis> up = {};               // instead of what the format says, or is guessed of it
  // Gets the share of the file that has been read, in (0, 1], about once a mebibyte; what it throws ends the reading.
  // load_mesh calls it for files that it reads from front to back, such as text.
  std::function<void(double share)> progress = {};
};

}  // namespace lodestone
