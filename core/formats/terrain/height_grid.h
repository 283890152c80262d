// Surfaces over a regular grid of heights, and the files that hold them: SRTM tiles, ESRI ASCII grids, bare numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "core/files/byte_reader.h"
#include "core/formats/common/read_config.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

inline constexpr float void_height = std::numeric_limits<float>::quiet_NaN();

// Posts in rows from north to south, each from west to east. x runs east, y north and z up, all from the south-west
// post unless an origin says otherwise.
struct HeightGrid {
  std::size_t width = 0, height = 0;    // posts, at least 2 each
  double spacing_x = 1, spacing_y = 1;  // between posts, in the unit of the heights
  double origin_x = 0, origin_y = 0;    // of the south-west post
  std::vector<float> heights;           // width * height; void_height: unknown
  [[nodiscard]] std::size_t posts() const { return width * height; }
};

// Interpolates every void post from the nearest known posts to the west, east, north and south, each weighted by the
// inverse of its distance, with the weights along an axis measured in posts of that axis: linear across a gap in a row
// or column, and exact on a plane where all four exist. Posts without any (their row and column are void) follow in
// further passes. Returns the number of filled posts: 0 when every post is void. O(posts) time per pass, at most three
// passes; 16 bytes per post beside the grid.
std::uint64_t fill_voids(HeightGrid& grid);

// Two triangles for each quad of four known posts, counter-clockwise seen from above, the diagonal from south-west to
// north-east; a quad with a void corner stays open. Posts that no triangle uses do not become vertices. Row by row from
// the south, west first. Throws ResourceError, naming `name`, for more posts than 32-bit indices reach.
[[nodiscard]] RawMesh triangulate(const HeightGrid& grid, const std::string& name = {});

// One degree by one degree of SRTM heights (.hgt): 1201 x 1201 posts 3 arc seconds apart or 3601 x 3601 posts 1 arc
// second apart, told by the size; int16, big-endian, metres. Heights of -500 m and less are void (files have -32768 and
// -32767). The name gives the south-west corner: N49W124.
struct SrtmTile {
  int latitude = 0, longitude = 0;  // of the south-west corner, in degrees
  std::size_t side = 0;             // posts along it
  std::vector<float> heights;       // rows from the north; void_height: unknown
};
[[nodiscard]] SrtmTile read_srtm_tile(ByteReader& input);

// Tiles as one grid, in metres from the south-west post: neighbours share a row or column of posts, and where one of
// the two is void there the other counts. Posts that no tile covers are void. The map is equirectangular (snyder1987,
// chapter 12): a sphere of R = 6371 km, y = R latitude, x = R longitude cos(middle latitude of all tiles), angles in
// radians. scripts/terrain does the same. Throws InputError for tiles that have several resolutions, overlap, differ
// where they meet, or cover less than a quarter of their rectangle.
[[nodiscard]] HeightGrid join_srtm_tiles(std::vector<SrtmTile> tiles, const std::string& name);

// ESRI ASCII grid (.asc): ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize, NODATA_value, then
// rows from the north. x and y are the centres of cells, as heights are taken there.
[[nodiscard]] HeightGrid read_esri_grid(ByteReader& input);

// Numbers as `format` describes them, and nothing else. Void: -32768 and -32767 of int16; values that are not finite
// and -9999 of floating-point types.
[[nodiscard]] HeightGrid read_bare_grid(ByteReader& input, const RawGridFormat& format);

// The surface, with voids open or filled as `config` says; it counts both.
[[nodiscard]] RawMesh mesh_of_grid(HeightGrid&& grid, const ReadConfig& config, const std::string& name);

// The .hgt files of a folder, sorted by name.
[[nodiscard]] std::vector<std::filesystem::path> list_srtm_tiles(const std::filesystem::path& folder);
[[nodiscard]] RawMesh read_srtm_folder(const std::filesystem::path& folder, const ReadConfig& config);

// Readers of single files as meshes.
[[nodiscard]] RawMesh read_hgt(ByteReader& input, const ReadConfig& config = {});
[[nodiscard]] RawMesh read_ascii_grid(ByteReader& input, const ReadConfig& config = {});
[[nodiscard]] RawMesh read_raw_grid(ByteReader& input, const ReadConfig& config);

}  // namespace lodestone
