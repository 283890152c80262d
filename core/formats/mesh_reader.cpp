#include "core/formats/mesh_reader.h"

#include <array>
#include <cstdint>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/files/text_scanner.h"
#include "core/formats/gltf/gltf.h"
#include "core/formats/obj/obj.h"
#include "core/formats/plain/draco.h"
#include "core/formats/plain/off.h"
#include "core/formats/plain/stl.h"
#include "core/formats/ply/ply.h"
#include "core/formats/terrain/height_grid.h"
#include "core/formats/tiles/tileset.h"

namespace lodestone {
namespace {

std::optional<MeshFormat> format_of_content(ByteReader& input) {
  const std::string_view head = input.window(4096).substr(0, 4096);
  if (head.starts_with("ply")) return MeshFormat::ply;
  if (head.starts_with("DRACO")) return MeshFormat::draco;
  if (head.starts_with("glTF")) return MeshFormat::gltf;
  if (head.substr(0, head.find_first_of(" \t\r\n")).ends_with("OFF")) return MeshFormat::off;
  if (head.size() >= stl_header_bytes && head.find('\0') != std::string_view::npos) {
    // Files of other kinds have zeros as well: only one that holds all of its facets is told from them.
    if (is_complete_stl(head, input.size())) return MeshFormat::stl;
  } else if (head.starts_with("solid")) {
    return MeshFormat::stl;
  } else if (head.starts_with("v ") || head.find("\nv ") != std::string_view::npos) {
    return MeshFormat::obj;
  }
  return std::nullopt;
}

// Files of other programs, told by how they begin or, where that says nothing, by their extension. Several hold zeros
// early on, or the word `solid`, and would pass for an STL.
struct ForeignFormat {
  std::string_view beginning, extension, name, remedy;
};
constexpr std::string_view from_program = "export a .glb, .obj or .ply from the program that wrote it";
constexpr std::string_view from_cad = "mesh its surfaces in a CAD program and export a .stl or .ply";
constexpr std::string_view from_points = "it holds points; make a surface of them and give that as a .ply";
constexpr std::string_view from_raster =
    "convert its heights to an ESRI ASCII grid (.asc), say by gdal_translate -of AAIGrid";
constexpr std::string_view from_archive = "unpack it and give the mesh that it holds";
constexpr ForeignFormat foreign_formats[] = {
    {"Kaydara FBX", ".fbx", "FBX", from_program},
    {"BLENDER", ".blend", "Blender", from_program},
    {"PXR-USDC", ".usdc", "USD", from_program},
    {"#usda", ".usda", "USD", from_program},
    {"#VRML", ".wrl", "VRML", from_program},
    {"", ".3ds", "3DS", from_program},
    {"", ".dae", "COLLADA", from_program},
    {"", ".dxf", "DXF", from_program},
    {"", ".x3d", "X3D", from_program},
    {"ISO-10303-21", ".step", "STEP", from_cad},
    {"", ".stp", "STEP", from_cad},
    {"", ".iges", "IGES", from_cad},
    {"LASF", ".las", "LAS", from_points},
    {"", ".laz", "LAZ", from_points},
    {"", ".xyz", "XYZ", from_points},
    {"ASTM-E57", ".e57", "E57", from_points},
    {{"II*\0", 4}, ".tif", "TIFF", from_raster},
    {{"MM\0*", 4}, ".tiff", "TIFF", from_raster},
    {"\x89HDF", ".h5", "HDF5", from_raster},
    {"CDF", ".nc", "NetCDF", from_raster},
    {"PK\3\4", ".zip", "ZIP", from_archive},
    {"\x1f\x8b", ".gz", "gzip", from_archive},
    {"\xfd\x37zXZ", ".xz", "xz", from_archive},
    {"7z\xbc\xaf", ".7z", "7z", from_archive},
};

[[noreturn]] void fail_foreign(const ByteReader& input, const ForeignFormat& format) {
  const std::string what = "is a file of format " + std::string(format.name) + ", which is not read";
  throw UnsupportedError(describe(input.name(), "", what, std::string(format.remedy)));
}

void refuse_foreign_content(ByteReader& input) {
  const std::string_view head = input.window(16);
  for (const ForeignFormat& format : foreign_formats)
    if (!format.beginning.empty() && head.starts_with(format.beginning)) fail_foreign(input, format);
}

void refuse_foreign_extension(const std::filesystem::path& path, const ByteReader& input) {
  for (const ForeignFormat& format : foreign_formats)
    if (extension_of(path) == format.extension) fail_foreign(input, format);
}

// Bare heights of tiles that are known by their size: SRTM under another name, SRTM30 and GTOPO30 (.dem).
struct KnownGrid {
  std::uint64_t width, height;
  const char* spacing;
};
std::optional<KnownGrid> grid_of_size(std::uint64_t bytes) {
  constexpr std::array<KnownGrid, 4> known{
      {{1201, 1201, "90"}, {3601, 3601, "30"}, {4800, 6000, "930"}, {7200, 3600, "930"}}};
  for (const KnownGrid& grid : known)
    if (bytes == 2 * grid.width * grid.height) return grid;
  return std::nullopt;
}

[[noreturn]] void fail_unknown(const ByteReader& input) {
  std::string remedy =
      "give a .ply, .obj, .stl, .off, .drc, .glb, .gltf, .hgt or .asc file, or a tileset.json; or give --grid";
  if (const auto grid = grid_of_size(input.size())) {
    const std::string size = std::to_string(grid->width) + "x" + std::to_string(grid->height);
    remedy = "its size is that of " + size + " heights of 2 bytes: give --grid " + size + ":i16be:" + grid->spacing;
    if (grid->width == grid->height) remedy += ", or name it as an SRTM tile by its corner, such as N49W124.hgt";
  }
  throw UnsupportedError(describe(input.name(), "", "is not of a known mesh format", remedy));
}

// Readers that take a foreign file for one of theirs: its beginning for the free text of a header, or for lines without
// meaning.
bool takes_all(MeshFormat format, ByteReader& input) {
  return format == MeshFormat::obj ||
         (format == MeshFormat::stl && !is_complete_stl(input.window(stl_header_bytes), input.size()));
}

bool is_hierarchy(ByteReader& input) { return input.window(8).starts_with("\x93LODE"); }

}  // namespace

std::optional<MeshFormat> format_of_extension(const std::filesystem::path& path) {
  using enum MeshFormat;
  constexpr std::pair<const char*, MeshFormat> known[] = {
      {".ply", ply},  {".obj", obj},   {".stl", stl},      {".off", off}, {".drc", draco},
      {".glb", gltf}, {".gltf", gltf}, {".json", tileset}, {".hgt", hgt}, {".asc", ascii_grid}};
  const std::string extension = extension_of(path);
  for (const auto& [name, format] : known)
    if (extension == name) return format;
  return std::nullopt;
}

MeshFormat mesh_format(const std::filesystem::path& path, ByteReader& input, const ReadConfig& config) {
  if (const auto format = format_of_extension(path)) {
    if (takes_all(*format, input)) refuse_foreign_content(input);
    return *format;
  }
  if (is_hierarchy(input))  // its first bytes may look like a binary STL
    throw UnsupportedError(
        describe(input.name(), "", "is a hierarchy (.lode), not a mesh", "give the mesh that it was built from"));
  if (config.raw_grid) return MeshFormat::raw_grid;
  refuse_foreign_content(input);
  if (const auto format = format_of_content(input)) return *format;
  refuse_foreign_extension(path, input);
  fail_unknown(input);
}

Up up_of(MeshFormat format, const ReadConfig& config) {
  using enum MeshFormat;
  if (config.up) return {*config.up, false};
  switch (format) {
    case gltf:
      return {UpAxis::y, false};
    case tileset:
    case hgt:
    case ascii_grid:
    case raw_grid:
      return {UpAxis::z, false};
    case obj:
      return {UpAxis::y, true};
    case ply:
    case stl:
    case off:
    case draco:
      break;
  }
  return {UpAxis::z, true};
}

RawMesh read_mesh(ByteReader& input, MeshFormat format, const ReadConfig& config) {
  if (input.size() == 0) throw InputError(describe(input.name(), "", "is empty", "give a mesh with triangles"));
  try {
    RawMesh mesh = [&] {
      switch (format) {
        case MeshFormat::ply:
          return read_ply(input, config);
        case MeshFormat::obj:
          return read_obj(input, config);
        case MeshFormat::stl:
          return read_stl(input);
        case MeshFormat::off:
          return read_off(input, config);
        case MeshFormat::draco:
          return read_draco(input, config);
        case MeshFormat::gltf:
          return read_gltf(input, config);
        case MeshFormat::tileset:
          return read_tileset(input, config);
        case MeshFormat::hgt:
          return read_hgt(input, config);
        case MeshFormat::ascii_grid:
          return read_ascii_grid(input, config);
        case MeshFormat::raw_grid:
          break;
      }
      return read_raw_grid(input, config);
    }();
    require_triangles(mesh, input.name());
    if (format != MeshFormat::tileset || config.up) mesh.up = up_of(format, config);
    return mesh;
  } catch (const std::bad_alloc&) {
    throw_out_of_memory(input.name());
  } catch (const std::length_error&) {  // a vector of more than can be addressed
    throw_out_of_memory(input.name());
  }
}

ByteReader open_mesh_file(const std::filesystem::path& path, const ReadConfig& config) {
  std::optional<std::filesystem::path> limit;
  if (!config.allow_outside) limit = path.parent_path();
  return ByteReader(path, std::move(limit), config.progress);
}

std::filesystem::path mesh_path(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path / "tileset.json", ignored)) return path / "tileset.json";
  return path;
}

void require_triangles(const RawMesh& mesh, const std::string& name) {
  if (!mesh.triangles.empty()) return;
  std::string what = "has no triangle (" + std::to_string(mesh.positions.size()) + " vertices";
  if (mesh.faces_dropped != 0) what += ", " + std::to_string(mesh.faces_dropped) + " faces of fewer than 3 corners";
  throw InputError(describe(name, "", what + ")", "give a mesh with triangles"));
}

void throw_out_of_memory(const std::string& name) {
  throw ResourceError(describe(name, "", "there is not enough memory to read it", "give a smaller mesh"));
}

}  // namespace lodestone
