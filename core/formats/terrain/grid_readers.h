// Files of heights on a regular grid.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/files/byte_reader.h"
#include "core/formats/common/read_config.h"
#include "core/formats/terrain/height_grid.h"

namespace lodestone {

// One degree by one degree of SRTM heights (.hgt): 1201 x 1201 posts 3 arc seconds apart or 3601 x 3601 posts 1 arc
// second apart, told by the size; int16, big-endian, metres. Heights of -500 m and less are void (-32768 and -32767 are
// what files have). The name tells the south-west corner: N49W124.
struct SrtmTile {
  int latitude = 0, longitude = 0;  // of the south-west corner, in degrees
  std::size_t side = 0;             // posts along it
  std::vector<float> heights;       // rows from the north; NaN: void
};
[[nodiscard]] SrtmTile read_srtm_tile(ByteReader& input);

// Tiles as one grid, in metres from the south-west post: neighbours share a row or column of posts, and where one of
// the two is void there the other counts. What no tile covers is void. The map is equirectangular (snyder1987, chapter
// 12): a sphere of R = 6371 km, y = R latitude, x = R longitude cos(middle latitude of all tiles), angles in radians.
// scripts/terrain does the same. Throws InputError for tiles of several resolutions, that overlap, that differ where
// they meet, or that cover less than a quarter of their rectangle.
[[nodiscard]] HeightGrid join_srtm_tiles(std::vector<SrtmTile> tiles, const std::string& name);

// ESRI ASCII grid (.asc): ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize, NODATA_value, then
// rows from the north. x and y are the centres of cells, as heights are taken there.
[[nodiscard]] HeightGrid read_esri_grid(ByteReader& input);

// Numbers as config.raw_grid describes them, and nothing else. Void: -32768 and -32767 of int16; what is not finite
// and -9999 of floating-point types.
[[nodiscard]] HeightGrid read_bare_grid(ByteReader& input, const RawGridFormat& format);

// The surface, with voids open or filled as `config` says; counts both.
[[nodiscard]] RawMesh mesh_of_grid(HeightGrid&& grid, const ReadConfig& config, const std::string& name);

// The .hgt files of a folder, sorted by name.
[[nodiscard]] std::vector<std::filesystem::path> list_srtm_tiles(const std::filesystem::path& folder);
[[nodiscard]] RawMesh read_srtm_folder(const std::filesystem::path& folder, const ReadConfig& config);

}  // namespace lodestone
