#include "core/hierarchy/tiles/tileset_tree.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/error.h"
#include "core/files/json.h"
#include "core/formats/common/mesh_companions.h"
#include "core/formats/common/mesh_view.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/model/material_of.h"
#include "core/math/affine.h"
#include "core/math/round_up.h"
#include "core/mesh/up_axis.h"
#include "core/texture/image_codec.h"

namespace lodestone {
namespace {

std::string cell_name(const Hierarchy& hierarchy, CellId cell) {
  const CellCoord c = hierarchy.cells[cell].code.coord();
  std::string name = std::to_string(hierarchy.level_of(cell));
  char separator = '/';
  for (const std::uint16_t i : {c.x, c.y, c.z}) {
    name += separator;
    name += std::to_string(i);
    separator = '_';
  }
  return name;
}

double area(Vec3d a, Vec3d b, Vec3d c) { return 0.5 * length(cross(b - a, c - a)); }

double area(Vec2f a, Vec2f b, Vec2f c) {
  const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - a.x, vy = c.y - a.y;
  return 0.5 * std::abs(ux * vy - uy * vx);
}

ShownImage shown_image(const Hierarchy& hierarchy, std::uint32_t texture, int level) {
  if (texture >= hierarchy.textures.size()) return {};
  if (const TextureCopy* copy = texture_copy(hierarchy, texture, level))
    return {double{1} * copy->width * copy->height, static_cast<int>(copy->halvings)};
  const Texture& whole = hierarchy.textures[texture];
  try {
    const PixelSize size = image_size(whole.bytes, whole.media_type);
    return {double{1} * size.width * size.height, 0};
  } catch (const Error&) {  // tiles link it as it is
    return {};
  }
}

// By material: the coarsest of its images.
std::vector<ShownImage> coarsest_images(const Hierarchy& hierarchy, int level) {
  std::vector<ShownImage> images;
  for (const Material& m : hierarchy.materials) {
    ShownImage& coarsest = images.emplace_back();
    for_each_texture(m, [&](std::uint32_t texture) {
      const ShownImage image = shown_image(hierarchy, texture, level);
      if (image.texels > 0 && (coarsest.texels == 0 || image.texels < coarsest.texels)) coarsest = image;
    });
  }
  return images;
}

// Mean size of a texel on the textured triangles of a cell, in normalised units; 0 without any. Where the texture is no
// copy, its coordinates are interpolated between fewer vertices than at the finest level: a texel's shift is not
// counted in the cell's own error. Triangles inside one texel of the texture itself have one colour and lose nothing.
double texel_size(const Hierarchy& hierarchy, const Cell& cell, std::span<const ShownImage> images) {
  if (!hierarchy.attributes.uv) return 0;
  double surface = 0, texels = 0;
  for (const Triangle& t : cell.triangles) {
    const std::uint32_t material = material_of(hierarchy, cell, t.v[0]);
    if (material >= images.size()) continue;
    const auto at = [&](int k) { return to_double(cell.positions[t.v[static_cast<std::size_t>(k)]]); };
    const auto uv = [&](int k) { return cell.attributes.uv[t.v[static_cast<std::size_t>(k)]]; };
    const double seen = area(uv(0), uv(1), uv(2)) * images[material].texels;
    if (!(std::ldexp(seen, 2 * images[material].halvings) >= 1)) continue;
    surface += area(at(0), at(1), at(2));
    texels += seen;
  }
  return texels > 0 ? std::sqrt(surface / texels) : 0;
}

template <class Visit>
void for_each_shown_texture(const Material& m, const Visit& visit) {
  const bool glows = m.emissive != std::array<float, 3>{} && !m.unlit;
  for (const std::uint32_t texture : {m.texture, glows ? m.emissive_map.texture : no_texture})
    if (texture != no_texture) visit(texture);
}

// A file is in memory as a whole, here and in a viewer. Where cells fill space, and not a surface, five levels have
// tens of thousands.
constexpr std::size_t most_tiles_per_file = 4096;

class TreeEncoder {
 public:
  TreeEncoder(const Hierarchy& hierarchy, std::span<const double> errors, const TilesetConfig& config)
      : hierarchy_(hierarchy), config_(config), errors_(errors.begin(), errors.end()) {
    // Children come after their parents.
    for (std::size_t c = errors_.size(); c-- > 1;)
      if (const CellId parent = hierarchy.cells[c].parent; parent != no_cell)
        errors_[parent] = std::max(errors_[parent], errors_[c]);
    while (config_.levels_per_file > 1 && tiles_per_file() > most_tiles_per_file) --config_.levels_per_file;
  }

  std::vector<TilesetFile> encode() {
    Json root = tile(CellId(0), 0);
    root["transform"] = place_of_root();
    add_file("tileset.json", std::move(root), CellId(0));
    std::reverse(files_.begin(), files_.end());
    return std::move(files_);
  }

 private:
  // The model's origin, and its up axis turned to z. On the Earth tilesets have up where it is.
  [[nodiscard]] Json place_of_root() const {
    const UpAxis up = hierarchy_.transform.up.axis;
    const Vec3d z = direction_of(UpAxis::z, {});
    const Affine3d turn = turn_between(up == UpAxis::earth ? z : direction_of(up, {}), z);
    const auto [x_axis, y_axis, z_axis] = turn.axes;
    const Vec3d o = turn.vector(hierarchy_.transform.origin);
    return {x_axis.x, x_axis.y, x_axis.z, 0, y_axis.x, y_axis.y, y_axis.z, 0,
            z_axis.x, z_axis.y, z_axis.z, 0, o.x,      o.y,      o.z,      1};
  }

  // Mean number of tiles below those of the deepest level at which files are cut off.
  [[nodiscard]] std::size_t tiles_per_file() const {
    const int first = std::max(hierarchy_.finest() - config_.levels_per_file, 0);
    const Level& roots = hierarchy_.levels[static_cast<std::size_t>(first)];
    return (hierarchy_.cells.size() - roots.first_cell) / roots.cell_count;
  }

  // True at levels finest - n, finest - 2 n, ... of a large tree.
  [[nodiscard]] bool is_cut(int level) const {
    if (hierarchy_.cells.size() <= config_.max_tiles || level == 0 || level == hierarchy_.finest()) return false;
    return (hierarchy_.finest() - level) % config_.levels_per_file == 0;
  }

  // `top`: level of the root of the file that it is written to.
  Json tile(CellId index, int top) {
    const int level = hierarchy_.level_of(index);
    const Cell& cell = hierarchy_.cells[index];
    Json tile{{"boundingVolume", box(cell, level)}, {"geometricError", errors_[index]}};
    if (is_cut(level) && level != top) {
      const std::string path = cell_name(hierarchy_, index) + ".json";
      add_file(path, this->tile(index, level), index);
      tile["content"] = {{"uri", from(top, path)}};
      return tile;
    }
    if (level == top) tile["refine"] = "REPLACE";
    if (!cell.triangles.empty()) tile["content"] = {{"uri", from(top, tile_path(hierarchy_, index))}};
    if (config_.morph) tile["extras"] = morph_of(index, level);
    for (CellId k = cell.first_child; k < cell.end_child(); ++k) tile["children"].push_back(this->tile(k, top));
    return tile;
  }

  // tileset.json lies in the folder itself, the others one below.
  [[nodiscard]] static std::string from(int top, const std::string& path) { return top == 0 ? path : "../" + path; }

  // Relative to the origin, that is before the root's transform.
  [[nodiscard]] Json box(const Cell& cell, int level) const {
    const double scale = hierarchy_.transform.scale;
    const double slack = std::ldexp(1.0, -40) * (1 + hierarchy_.finest() - level);
    const auto half = [&](float lo, float hi) { return scale * (0.5 * (double{hi} - lo) + slack); };
    const auto [lo, hi] = cell.bounds;
    const Vec3d middle = 0.5 * scale * (to_double(lo) + to_double(hi));
    return {{"box",
             {middle.x, middle.y, middle.z, half(lo.x, hi.x), 0, 0, 0, half(lo.y, hi.y), 0, 0, 0, half(lo.z, hi.z)}}};
  }

  // A viewer with a budget of memory decides by these before it loads anything: vertices and triangles of the file, and
  // the textures of base colours and light, whose texels morph_of_levels() tells.
  [[nodiscard]] Json morph_of(CellId index, int level) {
    const Cell& cell = hierarchy_.cells[index];
    const auto [lo, hi] = cell.bounds;
    const TileContent& content = config_.contents.at(index);
    Json extras{{"level", level},
                {"bounds", {lo.x, lo.y, lo.z, hi.x, hi.y, hi.z}},
                {"vertices", content.vertices},
                {"triangles", cell.triangles.size()}};
    if (config_.signatures) extras["error"] = cell.error;
    for (const TileImage& image : content.images) {
      extras["textures"].push_back(image.path);
      texels_[image.path] = image.texels;
      if (const auto found = config_.thumbnails.find(image.texture); found != config_.thumbnails.end())
        thumbnails_[image.path] = found->second;
    }
    return extras;
  }

  [[nodiscard]] Json morph_of_levels() const {
    Json reach, error;
    for (const Level& level : hierarchy_.levels) {
      reach.push_back({{"euclidean", level.reach[0]}, {"chebyshev", level.reach[1]}});
      error.push_back(level.error);
    }
    const Vec3d origin = hierarchy_.transform.origin;
    Json figures{{"sigma0", hierarchy_.sigma0},
                 {"scale", hierarchy_.transform.scale},
                 {"up", name_of(hierarchy_.transform.up.axis)},
                 {"origin", {origin.x, origin.y, origin.z}},
                 {"reach", reach},
                 {"error", error},
                 {"texels", texels_},
                 {"thumbnails", thumbnails_}};
    if (hierarchy_.grids.halves) figures["half_levels"] = true;
    if (config_.signatures) figures["signatures"] = signatures_path;
    return figures;
  }

  void add_file(const std::string& path, Json root, CellId cell) {
    Json tileset{{"asset", {{"version", "1.1"}}}, {"geometricError", errors_[cell]}, {"root", std::move(root)}};
    // If nothing is drawn, the error is the size of the model.
    if (cell == 0) {
      const auto [lo, hi] = hierarchy_.cells[0].bounds;
      const double size = product_up(hierarchy_.transform.scale, length_up(to_double(hi) - to_double(lo)));
      tileset["geometricError"] = std::max(size, errors_[0]);
      tileset["asset"]["extras"] = {{"generator", "Lodestone"}};
      if (config_.morph) tileset["extras"]["lodestone"] = morph_of_levels();
    }
    files_.push_back({path, tileset.dump()});
  }

  const Hierarchy& hierarchy_;
  TilesetConfig config_;
  std::vector<double> errors_;
  std::map<std::string, double> texels_;           // of textures, by path; 0: unknown
  std::map<std::string, std::string> thumbnails_;  // likewise, of those that have one
  std::vector<TilesetFile> files_;
};

}  // namespace

std::string tile_path(const Hierarchy& hierarchy, CellId cell) { return cell_name(hierarchy, cell) + ".glb"; }

std::string atlas_path(const Hierarchy& hierarchy, CellId cell, const TileAtlas& atlas, std::size_t image) {
  return cell_name(hierarchy, cell) + "_" + std::to_string(image) + image_extension(atlas.images[image].media_type);
}

std::string texture_path(const Hierarchy& hierarchy, std::uint32_t texture, int level) {
  std::string path = "textures/" + std::to_string(texture);
  if (const TextureCopy* copy = texture_copy(hierarchy, texture, level)) {
    path += '_';
    path += std::to_string(copy->halvings);
  }
  return path + image_extension(hierarchy.textures[texture].media_type);
}

TileContent tile_content(const Hierarchy& hierarchy, CellId cell, const TileAtlas& atlas) {
  const int level = hierarchy.level_of(cell);
  const Cell& of = hierarchy.cells[cell];
  std::map<std::string, TileImage> images;
  const auto add = [&](std::string path, double texels, std::uint32_t texture) {
    images.try_emplace(path, TileImage{path, texels, texture});
  };
  std::set<std::uint32_t> materials;
  std::vector<bool> is_used(of.positions.size());
  for (const Triangle& t : of.triangles) {
    materials.insert(material_of(hierarchy, of, t.v[0]));
    for (const std::uint32_t v : t.v) is_used[v] = true;
  }
  for (const std::uint32_t material : materials) {
    if (material >= hierarchy.materials.size()) continue;
    if (const auto replacing = atlas.replacing(material)) {
      for_each_shown_texture(atlas.materials[*replacing], [&](std::uint32_t image) {
        const Texture& texture = atlas.images[image];
        const PixelSize size = image_size(texture.bytes, texture.media_type);
        add(atlas_path(hierarchy, cell, atlas, image), double{1} * size.width * size.height, no_texture);
      });
    } else {
      for_each_shown_texture(hierarchy.materials[material], [&](std::uint32_t texture) {
        if (texture >= hierarchy.textures.size()) return;
        add(texture_path(hierarchy, texture, level), shown_image(hierarchy, texture, level).texels, texture);
      });
    }
  }
  TileContent content{static_cast<std::uint32_t>(std::ranges::count(is_used, true)), {}};
  for (auto& [path, image] : images) content.images.push_back(std::move(image));
  return content;
}

TileErrors::TileErrors(const Hierarchy& hierarchy) : hierarchy_(hierarchy) {
  for (int level = 0; level < hierarchy.finest(); ++level) coarsest_.push_back(coarsest_images(hierarchy, level));
}

double TileErrors::of(CellId cell) const {
  const int level = hierarchy_.level_of(cell);
  if (level == hierarchy_.finest()) return 0;
  const Cell& at = hierarchy_.cells[cell];
  const double texel = texel_size(hierarchy_, at, coarsest_[static_cast<std::size_t>(level)]);
  return product_up(hierarchy_.transform.scale, std::max(double{at.error}, texel));
}

std::string encode_signatures(const Hierarchy& hierarchy, const Signatures& signatures) {
  const Signatures::Table& table = signatures.table();
  Json levels = Json::array();
  std::size_t first = 0, cell = 0;
  for (std::size_t level = 0; level < table.sets.size(); ++level) {
    const std::size_t end = first + table.sets[level];
    std::vector<std::vector<std::uint32_t>> sets;
    for (std::size_t set = first; set < end; cell += table.sizes[set++]) {
      std::vector<std::uint32_t>& cells = sets.emplace_back();
      for (const CellId c : std::span(table.cells).subspan(cell, table.sizes[set]))
        cells.push_back(c - hierarchy.levels[level].first_cell);
    }
    const std::span errors = std::span(table.errors).subspan(first, end - first);
    levels.push_back({{"cells", sets}, {"errors", std::vector<float>(errors.begin(), errors.end())}});
    first = end;
  }
  return levels.dump();
}

std::vector<TilesetFile> encode_tilesets(const Hierarchy& hierarchy, std::span<const double> errors,
                                         const TilesetConfig& config) {
  return TreeEncoder(hierarchy, errors, config).encode();
}

}  // namespace lodestone
