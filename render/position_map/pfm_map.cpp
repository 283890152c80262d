// Portable float maps: "PF", width and height, a scale whose sign tells the byte order, then rows from the bottom.
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/files/input_file.h"
#include "render/position_map/map_files.h"
#include "render/position_map/map_view.h"
#include "render/position_map/read_map.h"

namespace lodestone {
namespace {

struct PfmHeader {
  int width = 0, height = 0;
  bool big_endian = false;
  std::size_t bytes = 0;  // of the header
};

[[noreturn]] void fail(const std::string& name, const std::string& what) { throw InputError(describe(name, "", what)); }

PfmHeader parse_header(std::string_view text, const std::string& name) {
  std::size_t at = 0;
  const auto word = [&] {
    while (at < text.size() && std::strchr(" \t\r\n", text[at])) ++at;
    const std::size_t first = at;
    while (at < text.size() && !std::strchr(" \t\r\n", text[at])) ++at;
    return text.substr(first, at - first);
  };
  const auto number = [&](auto& value) {
    const std::string_view w = word();
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    if (w.empty() || error != std::errc{} || end != w.data() + w.size())
      fail(name, "is not a portable float map: the header is malformed");
  };
  if (word() != "PF") fail(name, "is not a portable float map of three channels (PF)");
  PfmHeader header;
  double scale = 0;
  number(header.width), number(header.height), number(scale);
  if (header.width < 1 || header.height < 1 || header.width > largest_map_side || header.height > largest_map_side)
    fail(name, "an image of " + std::to_string(header.width) + "x" + std::to_string(header.height) + " pixels");
  if (!std::isfinite(scale) || scale == 0) fail(name, "is not a portable float map: the scale is zero or not a number");
  header.big_endian = scale > 0;
  header.bytes = at + 1;  // one white space ends the header
  return header;
}

float load_float(const std::byte* from, bool big_endian) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, from, 4);
  if (big_endian != (std::endian::native == std::endian::big)) bits = __builtin_bswap32(bits);
  return std::bit_cast<float>(bits);
}

}  // namespace

void write_pfm_map(const std::filesystem::path& path, const PositionMap& map) {
  const auto width = static_cast<std::size_t>(map.view.width);
  const std::string header = "PF\n" + std::to_string(map.view.width) + " " + std::to_string(map.view.height) +
                             (std::endian::native == std::endian::little ? "\n-1.0\n" : "\n1.0\n");
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  AtomicFile file(path);
  file.write(std::as_bytes(std::span(header)));
  std::vector<Vec3f> row(width);
  for (int y = map.view.height - 1; y >= 0; --y) {
    const std::size_t first = static_cast<std::size_t>(y) * width;
    for (std::size_t x = 0; x < width; ++x)
      row[x] = map.sees(first + x) ? map.position[first + x] : Vec3f{nan, nan, nan};
    file.write(std::as_bytes(std::span(row)));
  }
  file.commit();
}

PositionMap read_pfm_map(const std::filesystem::path& path, const MapView& view, const Transform& transform) {
  return parse_pfm_map(MappedFile(path).bytes(), path.string(), view, transform);
}

PositionMap parse_pfm_map(std::span<const std::byte> bytes, const std::string& name, const MapView& view,
                          const Transform& transform) {
  const PfmHeader header =
      parse_header({reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 256)}, name);
  PositionMap map;
  map.view = view;
  map.transform = transform;
  map.view.width = header.width, map.view.height = header.height;
  const std::size_t n = map.view.pixels(), width = static_cast<std::size_t>(header.width);
  if (bytes.size() < header.bytes || bytes.size() - header.bytes < 12 * n) fail(name, "the file is cut off");
  map.position.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t row = static_cast<std::size_t>(header.height) - 1 - i / width;
    const std::byte* from = bytes.data() + header.bytes + 12 * (row * width + i % width);
    map.position[i] = {load_float(from, header.big_endian), load_float(from + 4, header.big_endian),
                       load_float(from + 8, header.big_endian)};
  }
  complete_map(map, name);
  return map;
}

}  // namespace lodestone
