#include "core/formats/tiles/tileset.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

#include "core/base/error.h"
#include "core/files/json_view.h"
#include "core/files/scalar.h"
#include "core/files/text_scanner.h"
#include "core/formats/common/companion_files.h"
#include "core/formats/gltf/gltf.h"
#include "core/formats/gltf/gltf_document.h"
#include "core/formats/gltf/gltf_surface.h"
#include "core/math/vec3.h"
#include "core/mesh/raw_mesh.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

constexpr const char* damaged = "the file is damaged";
constexpr int deepest = 256;  // nesting of tiles, external tilesets included
// Files of a few bytes can refer to each other so that the tree they make never ends. A tileset may be used several
// times, in different places, but not much oftener than this.
constexpr std::uint64_t most_uses = 16, always_allowed = 1000;

// Turns models of this up axis so that z is up. glTF has y up; old tilesets may say otherwise.
Affine3d up_to_z(const JsonView& asset) {
  const std::string axis = asset.string_or("gltfUpAxis", "Y");
  if (axis == "Z" || axis == "z") return {};
  if (axis == "X" || axis == "x") return {{Vec3d{0, 0, 1}, Vec3d{0, 1, 0}, Vec3d{-1, 0, 0}}, {}};
  return {{Vec3d{1, 0, 0}, Vec3d{0, 0, 1}, Vec3d{0, -1, 0}}, {}};
}

class TilesetWalk {
 public:
  // Adds the tiles of a tileset; `map` leads from its root's coordinates on.
  void add_tileset(ByteReader& input, const Affine3d& map, int depth) {
    count_use(input.name());
    const std::vector<char> text = read_all(input);
    const Json json = parse_json(text, input.name());
    const Tileset tileset{JsonView(json, input.name()), input.name(), input.folder(), CompanionFiles(input.folder())};
    const JsonView asset = tileset.root.at("asset");
    const std::string version = asset.at("version").string();
    if (!version.starts_with("1.") && !version.starts_with("0."))
      throw UnsupportedError(
          describe(input.name(), asset.place(), "3D Tiles of version " + quote(version), "convert it to 3D Tiles 1.1"));
    add_tile(tileset, tileset.root.at("root"), map, "REPLACE", depth);
  }

  [[nodiscard]] TileList result() && { return std::move(list_); }

 private:
  struct Tileset {
    JsonView root;
    std::string file;
    std::optional<CompanionFolder> folder;  // none for bytes in memory, so that every tile is missing
    CompanionFiles files;
  };

  void count_use(const std::string& file) {
    files_.insert(file);
    if (++uses_ > std::max(always_allowed, most_uses * files_.size()))
      throw InputError(describe(file, "",
                                std::to_string(files_.size()) + " tilesets refer to each other more than " +
                                    std::to_string(uses_ - 1) + " times",
                                "let each be the content of few tiles"));
  }

  // Adds a tile and its descendants; true if any of them has content.
  bool add_tile(const Tileset& tileset, const JsonView& tile, const Affine3d& outer, std::string refine, int depth) {
    if (depth > deepest)
      tile.fail("lies below more than " + std::to_string(deepest) + " others", "does the tileset refer to itself?");
    if (tile.find("implicitTiling") || extension(tile, "3DTILES_implicit_tiling"))
      throw UnsupportedError(describe(tileset.file, tile.place(), "implicit tiling", "write the tiles out one by one"));
    const std::optional<JsonView> transform = tile.find("transform");
    const Affine3d map = transform ? outer * affine_of(*transform) : outer;
    refine = tile.string_or("refine", refine);
    if (refine != "REPLACE" && refine != "ADD") tile.fail("unknown refinement " + quote(refine), damaged);

    // Content goes before that of the children; with REPLACE it counts only if they have none.
    const std::size_t here = list_.tiles.size();
    bool refined = false;
    if (const std::optional<JsonView> children = tile.find("children"))
      for (std::size_t i = 0; i < children->size(); ++i)
        refined = add_tile(tileset, children->at(i), map, refine, depth + 1) || refined;
    if (refine == "REPLACE" && refined) return true;
    const std::size_t children_end = list_.tiles.size();
    const bool has_content = add_contents(tileset, tile, map, depth);
    std::rotate(list_.tiles.begin() + static_cast<std::ptrdiff_t>(here),
                list_.tiles.begin() + static_cast<std::ptrdiff_t>(children_end), list_.tiles.end());
    return refined || has_content;
  }

  bool add_contents(const Tileset& tileset, const JsonView& tile, const Affine3d& map, int depth) {
    bool any = false;
    if (const std::optional<JsonView> content = tile.find("content")) any = add_content(tileset, *content, map, depth);
    if (const std::optional<JsonView> contents = tile.find("contents"))
      for (std::size_t i = 0; i < contents->size(); ++i) any = add_content(tileset, contents->at(i), map, depth) || any;
    return any;
  }

  bool add_content(const Tileset& tileset, const JsonView& content, const Affine3d& map, int depth) {
    const std::optional<JsonView> uri = content.find("uri");
    const JsonView reference = uri ? *uri : content.at("url");  // the name in 3D Tiles 0.0
    const std::string name = percent_decoded(reference.string().substr(0, reference.string().find_first_of("?#")));
    const std::optional<fs::path> file = tileset.files.find_exactly(name);
    if (!file) {
      const auto [what, remedy] = tileset.files.absence(name);
      throw FileError(describe(tileset.file, reference.place(), "the tile " + quote(name) + " " + what, remedy));
    }
    const std::string extension = extension_of(*file);
    if (extension == ".json") {
      ByteReader input(*file, tileset.folder->limit);
      const std::size_t before = list_.tiles.size();
      add_tileset(input, map, depth + 1);
      return list_.tiles.size() > before;
    }
    const std::string place = describe(tileset.file, reference.place(), quote(name));
    if (extension == ".pnts" || extension == ".i3dm" || extension == ".cmpt") {
      list_.warnings.push_back(place + " is not a plain mesh and is left out");
      return false;
    }
    list_.tiles.push_back({*file, tileset.folder->limit, map, up_to_z(tileset.root.at("asset")), place});
    return true;
  }

  TileList list_;
  std::set<std::string> files_;  // tilesets
  std::uint64_t uses_ = 0;
};

// The header of a Batched 3D Model: magic, version, then five lengths in bytes.
struct BatchedHeader {
  std::uint32_t version = 0, bytes = 0, feature_json = 0, feature_binary = 0, batch_json = 0, batch_binary = 0;
  [[nodiscard]] std::uint64_t model_offset() const {
    return std::uint64_t{28} + feature_json + feature_binary + batch_json + batch_binary;
  }
};

BatchedHeader read_batched_header(std::span<const char> bytes, const std::string& name) {
  const auto fail = [&](std::size_t at, const std::string& what) {
    throw InputError(describe(name, "byte " + std::to_string(at), what, "the file is truncated or damaged"));
  };
  if (bytes.size() < 28) fail(bytes.size(), "the file ends in its header");
  std::array<std::uint32_t, 6> words{};
  for (std::size_t i = 0; i < 6; ++i) words[i] = load<std::uint32_t>(bytes.data() + 4 + 4 * i);
  const BatchedHeader header{words[0], words[1], words[2], words[3], words[4], words[5]};
  if (header.version != 1)
    throw UnsupportedError(describe(name, "byte 4", "Batched 3D Model of version " + std::to_string(header.version)));
  if (header.bytes > bytes.size() || header.model_offset() > header.bytes)
    fail(8, "declares tables and a model of " +
                std::to_string(std::max<std::uint64_t>(header.bytes, header.model_offset())) + " bytes, the file has " +
                std::to_string(bytes.size()));
  return header;
}

RawMesh read_batched(ByteReader& input, const Affine3d& up, const ReadConfig& config) {
  const std::vector<char> bytes = read_all(input);
  const BatchedHeader header = read_batched_header(bytes, input.name());
  const std::span<const char> whole = std::span(bytes).first(header.bytes);
  ByteReader model(whole.subspan(header.model_offset()), input.name(), input.folder());
  RawMesh mesh = read_gltf(model, config);
  transform_mesh(mesh, up);
  if (header.feature_json == 0) return mesh;
  const Json features = parse_json(whole.subspan(28, header.feature_json), input.name());
  const std::array<double, 3> centre =
      JsonView(features, input.name(), "feature table").numbers_or<3>("RTC_CENTER", {});
  transform_mesh(mesh, {Affine3d{}.axes, {centre[0], centre[1], centre[2]}});
  return mesh;
}

}  // namespace

TileList list_tiles(ByteReader& input) {
  TilesetWalk walk;
  walk.add_tileset(input, {}, 0);
  return std::move(walk).result();
}

RawMesh read_tile(const Tile& tile, const ReadConfig& config) {
  ByteReader input(tile.file, tile.limit);
  RawMesh mesh;
  if (input.window(4).starts_with("b3dm")) {
    mesh = read_batched(input, tile.up_to_z, config);
  } else {
    mesh = read_gltf(input, config);
    transform_mesh(mesh, tile.up_to_z);
  }
  transform_mesh(mesh, tile.map);
  return mesh;
}

Up up_of_tiles(const Box3d& box) {
  constexpr double lowest = 6.3e6, highest = 6.4e6;  // metres from the middle of the Earth
  const double height = !box.empty() ? length(0.5 * (box.lo + box.hi)) : 0;
  return {height > lowest && height < highest ? UpAxis::earth : UpAxis::z, false};
}

RawMesh read_tileset(ByteReader& input, const ReadConfig& config) {
  TileList list = list_tiles(input);
  RawMesh mesh;
  mesh.warnings = std::move(list.warnings);
  for (const Tile& tile : list.tiles) append_mesh(mesh, read_tile(tile, config), input.name());
  mesh.up = up_of_tiles(finite_box(mesh.positions));
  return mesh;
}

}  // namespace lodestone
