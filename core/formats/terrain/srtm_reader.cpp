// SRTM height tiles (.hgt).
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/files/scalar.h"
#include "core/files/text_scanner.h"
#include "core/formats/terrain/height_grid.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::size_t, 2> sides{1201, 3601};  // 3 and 1 arc seconds
constexpr float lowest = -500;                           // metres; no dry land is lower
constexpr double earth_radius = 6371000;                 // metres

// "N49W124": latitude and longitude in degrees.
std::optional<std::pair<int, int>> corner_of(std::string name) {
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const auto digits = [&](std::size_t at, std::size_t count) {
    return std::all_of(name.begin() + static_cast<std::ptrdiff_t>(at),
                       name.begin() + static_cast<std::ptrdiff_t>(at + count),
                       [](unsigned char c) { return std::isdigit(c) != 0; });
  };
  if (name.size() != 7 || !digits(1, 2) || !digits(4, 3)) return std::nullopt;
  if ((name[0] != 'N' && name[0] != 'S') || (name[3] != 'E' && name[3] != 'W')) return std::nullopt;
  const int latitude = std::stoi(name.substr(1, 2)) * (name[0] == 'N' ? 1 : -1);
  const int longitude = std::stoi(name.substr(4)) * (name[3] == 'E' ? 1 : -1);
  if (latitude < -90 || latitude > 89 || longitude < -180 || longitude > 179) return std::nullopt;
  return std::pair(latitude, longitude);
}

// The rectangle of tiles, in degrees.
struct Extent {
  int south = 90, north = -91, west = 180, east = -181;  // of south-west corners, both ends included
  [[nodiscard]] std::size_t rows() const { return static_cast<std::size_t>(north - south + 1); }
  [[nodiscard]] std::size_t columns() const { return static_cast<std::size_t>(east - west + 1); }
};

Extent extent_of(const std::vector<SrtmTile>& tiles) {
  Extent e;
  for (const SrtmTile& tile : tiles) {
    e.south = std::min(e.south, tile.latitude), e.north = std::max(e.north, tile.latitude);
    e.west = std::min(e.west, tile.longitude), e.east = std::max(e.east, tile.longitude);
  }
  return e;
}

std::string corner_name(const SrtmTile& tile) {
  const auto part = [](int degrees, char positive, char negative, std::size_t width) {
    const std::string digits = std::to_string(std::abs(degrees));
    return (degrees < 0 ? negative : positive) + std::string(width - std::min(width, digits.size()), '0') + digits;
  };
  return part(tile.latitude, 'N', 'S', 2) + part(tile.longitude, 'E', 'W', 3);
}

void check_tiles(const std::vector<SrtmTile>& tiles, const Extent& extent, const std::string& name) {
  for (const SrtmTile& tile : tiles)
    if (tile.side != tiles.front().side)
      throw InputError(describe(name, corner_name(tile), "has another resolution than the tiles before it",
                                "join tiles of one resolution"));
  if (extent.rows() * extent.columns() > 4 * tiles.size())
    throw InputError(describe(name, "",
                              "the " + std::to_string(tiles.size()) + " tiles cover less than a quarter of their " +
                                  std::to_string(extent.rows()) + " by " + std::to_string(extent.columns()) +
                                  " degrees",
                              "build tiles that lie together"));
}

// Copies a tile to its place in the grid; posts that it shares with earlier tiles have to agree.
void insert(const SrtmTile& tile, const Extent& extent, HeightGrid& grid, const std::string& name) {
  const std::size_t steps = tile.side - 1;
  const std::size_t first_row = static_cast<std::size_t>(extent.north - tile.latitude) * steps;
  const std::size_t first_column = static_cast<std::size_t>(tile.longitude - extent.west) * steps;
  for (std::size_t row = 0; row < tile.side; ++row)
    for (std::size_t column = 0; column < tile.side; ++column) {
      const float height = tile.heights[row * tile.side + column];
      float& post = grid.heights[(first_row + row) * grid.width + first_column + column];
      const bool inside = row > 0 && row < steps && column > 0 && column < steps;
      if (!std::isnan(post) && !std::isnan(height) && (inside || post != height))
        throw InputError(describe(name, corner_name(tile),
                                  inside ? "is given twice"
                                         : "differs from its neighbour where they meet, by " +
                                               std::to_string(static_cast<int>(height - post)) + " m",
                                  "join tiles of one source"));
      if (!std::isnan(height)) post = height;
    }
}

}  // namespace

SrtmTile read_srtm_tile(ByteReader& input) {
  const auto corner = corner_of(fs::path(input.name()).stem().string());
  if (!corner)
    throw InputError(describe(input.name(), "", "the name is not that of a corner such as N49W124",
                              "name the tile after its south-west corner"));
  const auto side = std::find_if(sides.begin(), sides.end(), [&](std::size_t s) { return input.size() == 2 * s * s; });
  if (side == sides.end())
    throw InputError(describe(input.name(), "",
                              std::to_string(input.size()) + " bytes are neither 1201 x 1201 nor 3601 x 3601 heights",
                              "the tile is truncated or of another format"));
  const std::vector<char> bytes = read_all(input);
  if (bytes.size() != 2 * *side * *side) throw FileError(describe(input.name(), "", "the file has shrunk"));
  SrtmTile tile{corner->first, corner->second, *side, std::vector<float>(*side * *side)};
  for (std::size_t i = 0; i < tile.heights.size(); ++i) {
    const auto height = static_cast<float>(load<std::int16_t, std::endian::big>(bytes.data() + 2 * i));
    tile.heights[i] = height > lowest ? height : void_height;
  }
  return tile;
}

HeightGrid join_srtm_tiles(std::vector<SrtmTile> tiles, const std::string& name) {
  const Extent extent = extent_of(tiles);
  check_tiles(tiles, extent, name);
  const std::size_t steps = tiles.front().side - 1;
  const double degree = std::numbers::pi / 180;
  const double middle = (extent.south + extent.north + 1) * 0.5 * degree;
  HeightGrid grid{.width = extent.columns() * steps + 1, .height = extent.rows() * steps + 1, .heights = {}};
  grid.spacing_y = earth_radius * degree / static_cast<double>(steps);
  grid.spacing_x = grid.spacing_y * std::cos(middle);
  if (tiles.size() == 1) {
    grid.heights = std::move(tiles.front().heights);
    return grid;
  }
  grid.heights.assign(grid.posts(), void_height);
  for (SrtmTile& tile : tiles) {
    insert(tile, extent, grid, name);
    std::vector<float>().swap(tile.heights);
  }
  return grid;
}

RawMesh read_hgt(ByteReader& input, const ReadConfig& config) {
  std::vector<SrtmTile> tiles;
  tiles.push_back(read_srtm_tile(input));
  return mesh_of_grid(join_srtm_tiles(std::move(tiles), input.name()), config, input.name());
}

std::vector<fs::path> list_srtm_tiles(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (extension_of(entry->path()) == ".hgt") files.push_back(entry->path());
  }
  if (error) throw FileError(describe(folder.string(), "", "cannot read the folder: " + error.message()));
  std::sort(files.begin(), files.end());
  return files;
}

RawMesh read_srtm_folder(const fs::path& folder, const ReadConfig& config) {
  std::vector<SrtmTile> tiles;
  for (const fs::path& file : list_srtm_tiles(folder)) {
    ByteReader input(file);
    tiles.push_back(read_srtm_tile(input));
  }
  return mesh_of_grid(join_srtm_tiles(std::move(tiles), folder.string()), config, folder.string());
}

}  // namespace lodestone
