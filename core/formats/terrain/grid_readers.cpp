#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/base/error.h"
#include "core/files/scalar.h"
#include "core/files/text_scanner.h"
#include "core/formats/terrain/height_grid.h"

namespace lodestone {
namespace {

constexpr const char* damaged = "the file is damaged or not an ESRI grid";
// The lines "key value" before the heights, keys in lower case; the first number without a key ends them.
struct EsriHeader {
  std::map<std::string, double> values;
  std::string first_height;

  [[nodiscard]] bool has(const char* key) const { return values.count(key) != 0; }
  [[nodiscard]] double at(const TextScanner& scan, const char* key) const {
    const auto found = values.find(key);
    if (found == values.end()) scan.fail(std::string("the header has no '") + key + "'", damaged);
    return found->second;
  }
};

EsriHeader read_esri_header(TextScanner& scan) {
  EsriHeader header;
  while (true) {
    const std::string key = lower_case(scan.token_across_lines());
    if (key.empty()) scan.fail("the file ends in its header", damaged);
    if (parse_number(key) && key != "nan") {
      header.first_height = key;
      return header;
    }
    header.values[key] = scan.number(scan.token(), "a number of the header");
  }
}

// A number of posts: whole, from 2 to what can be counted.
std::size_t post_count(const TextScanner& scan, const EsriHeader& header, const char* key) {
  const double count = header.at(scan, key);
  if (!(count >= 2 && count <= 4294967295.0) || count != std::floor(count))
    scan.fail(std::string(key) + " of " + std::to_string(count), "a grid has at least 2 rows and 2 columns");
  return static_cast<std::size_t>(count);
}

// The centre of the first cell along an axis: given, or half a cell beside its corner.
double origin(const EsriHeader& header, const char* corner, const char* centre, double spacing) {
  if (header.has(centre)) return header.values.at(centre);
  return header.has(corner) ? header.values.at(corner) + spacing / 2 : 0;
}

}  // namespace

HeightGrid read_esri_grid(ByteReader& input) {
  TextScanner scan(input);
  const EsriHeader header = read_esri_header(scan);
  HeightGrid grid;
  grid.width = post_count(scan, header, "ncols");
  grid.height = post_count(scan, header, "nrows");
  // At least a digit and a separator each; the first has been read, the last needs no separator.
  if (grid.posts() / 2 > input.remaining() + 2)
    scan.fail("declares " + std::to_string(grid.width) + " x " + std::to_string(grid.height) + " heights, but only " +
                  std::to_string(input.remaining()) + " bytes follow",
              "the file is truncated, or its header is damaged");
  grid.spacing_x = header.has("dx") ? header.at(scan, "dx") : header.at(scan, "cellsize");
  grid.spacing_y = header.has("dy") ? header.at(scan, "dy") : grid.spacing_x;
  if (!(grid.spacing_x > 0) || !(grid.spacing_y > 0) || !std::isfinite(grid.spacing_x * grid.spacing_y))
    scan.fail("the cell size is not positive", damaged);
  grid.origin_x = origin(header, "xllcorner", "xllcenter", grid.spacing_x);
  grid.origin_y = origin(header, "yllcorner", "yllcenter", grid.spacing_y);
  if (!std::isfinite(grid.origin_x) || !std::isfinite(grid.origin_y)) scan.fail("the origin is not finite", damaged);
  const double no_data = header.has("nodata_value") ? header.at(scan, "nodata_value") : -9999;
  grid.heights.resize(grid.posts());
  std::string token = header.first_height;
  for (std::size_t i = 0; i < grid.posts(); ++i) {
    const double height = i == 0 ? scan.number(token, "a height") : scan.number(scan.token_across_lines(), "a height");
    const auto rounded = static_cast<float>(height);
    grid.heights[i] = height == no_data || !std::isfinite(rounded) ? void_height : rounded;
  }
  return grid;
}

HeightGrid read_bare_grid(ByteReader& input, const RawGridFormat& format) {
  HeightGrid grid{.width = format.width,
                  .height = format.height,
                  .spacing_x = format.spacing,
                  .spacing_y = format.spacing,
                  .heights = {}};
  const std::size_t size = size_of(format.type);
  const std::uint64_t bytes = input.size();
  if (bytes % size != 0 || bytes / size / grid.width != grid.height || bytes / size % grid.width != 0)
    throw InputError(describe(input.name(), "",
                              std::to_string(bytes) + " bytes are not " + std::to_string(grid.width) + " x " +
                                  std::to_string(grid.height) + " heights of " + std::to_string(size) + " bytes",
                              "check --grid"));
  const std::vector<char> data = read_all(input);
  grid.heights.resize(data.size() / size);
  for (std::size_t i = 0; i < grid.heights.size(); ++i) {
    const double height = load_as<double>(format.type, format.byte_order, data.data() + i * size);
    const bool is_void = is_integer(format.type)
                             ? format.type == ScalarType::int16 && (height == -32768 || height == -32767)
                             : height == -9999 || !std::isfinite(static_cast<float>(height));
    grid.heights[i] = is_void ? void_height : static_cast<float>(height);
  }
  if (grid.heights.size() != grid.posts()) throw FileError(describe(input.name(), "", "the file has shrunk"));
  return grid;
}

RawMesh mesh_of_grid(HeightGrid&& grid, const ReadConfig& config, const std::string& name) {
  const std::uint64_t filled = config.fill_voids ? fill_voids(grid) : 0;
  RawMesh mesh = triangulate(grid, name);
  mesh.filled_posts = filled;
  return mesh;
}

RawMesh read_ascii_grid(ByteReader& input, const ReadConfig& config) {
  return mesh_of_grid(read_esri_grid(input), config, input.name());
}

RawMesh read_raw_grid(ByteReader& input, const ReadConfig& config) {
  return mesh_of_grid(read_bare_grid(input, config.raw_grid.value()), config, input.name());
}

}  // namespace lodestone
