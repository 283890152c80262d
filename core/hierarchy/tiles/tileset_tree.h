// A hierarchy as a tileset of 3D Tiles 1.1 (OGC 22-025r4): a tile for each cell, which its children replace.
//
//   tileset.json | LEVEL/X_Y_Z.glb for each cell with triangles | textures/T.jpg, T_HALVINGS.jpg | LEVEL/X_Y_Z.json
//   LEVEL/X_Y_Z_0.jpg: atlases of a tile (tile_atlas.h) | signatures.json: for viewers that morph
//
// Large trees are cut: a tile whose content is another tileset (LEVEL/X_Y_Z.json) stands for a whole subtree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/hierarchy/model/signatures.h"
#include "core/hierarchy/tiles/tile_atlas.h"

namespace lodestone {

// An image that a tile shows as its base colours or light.
struct TileImage {
  std::string path;                    // from the folder of the tileset
  double texels = 0;                   // 0: unknown
  std::uint32_t texture = no_texture;  // of the hierarchy; no_texture: of an atlas
};

// The file of a tile, as far as it takes memory of a viewer.
struct TileContent {
  std::uint32_t vertices = 0;
  std::vector<TileImage> images;  // in the order of their paths
};

struct TilesetConfig {
  bool morph = false;                      // tiles have the attributes that a viewer needs to morph between levels
  const Signatures* signatures = nullptr;  // with `morph`: what radii by cell need, too; null: radii by level do
  std::size_t max_tiles = 4096;            // larger trees are cut
  // Subtrees of so many levels are cut off, at least 1: about 1400 tiles of a surface. Of fewer levels if they have
  // more than 4096 tiles on the average.
  int levels_per_file = 5;
  std::map<std::uint32_t, std::string> thumbnails{};  // files of them by texture, where there are any
  std::vector<TileContent> contents{};                // with `morph`: by cell
};

struct TilesetFile {
  std::string path;  // from the folder of the tileset
  std::string json;
};

[[nodiscard]] std::string tile_path(const Hierarchy& hierarchy, CellId cell);
// The file of an image of a tile's own, in the folder of the tile.
[[nodiscard]] std::string atlas_path(const Hierarchy& hierarchy, CellId cell, const TileAtlas& atlas,
                                     std::size_t image);

// The file of a texture as the level shows it.
[[nodiscard]] std::string texture_path(const Hierarchy& hierarchy, std::uint32_t texture, int level);

// An image as a level shows it.
struct ShownImage {
  double texels = 0;  // 0: none, or one that cannot be decoded
  int halvings = 0;
};

[[nodiscard]] TileContent tile_content(const Hierarchy& hierarchy, CellId cell, const TileAtlas& atlas);

// Distances of cells from the model, in its unit: the measured error of the surface, or the mean size on it of a texel
// of the coarsest image of its materials if that is larger. 0 on the finest level. The hierarchy outlives this.
class TileErrors {
 public:
  explicit TileErrors(const Hierarchy& hierarchy);
  [[nodiscard]] double of(CellId cell) const;

 private:
  const Hierarchy& hierarchy_;
  std::vector<std::vector<ShownImage>> coarsest_;  // by level, then by material
};

// The tileset.json, followed by those it refers to. `errors` has one value per cell; the values written do not decrease
// towards the root. Boxes contain those of their children, grown by rounding errors. The root's transform is the origin
// of the model, and turns it z up, as 3D Tiles have it.
[[nodiscard]] std::vector<TilesetFile> encode_tilesets(const Hierarchy& hierarchy, std::span<const double> errors,
                                                       const TilesetConfig& config = {});

// The content of `signatures_path`, beside the tileset.json that names it: by level the sets of two cells and more,
// numbered within the level, and the errors of the sets. Viewers that do not morph need not read it.
inline constexpr const char* signatures_path = "signatures.json";
[[nodiscard]] std::string encode_signatures(const Hierarchy& hierarchy, const Signatures& signatures);

struct CellGlbConfig {
  bool morph = false;  // as in TilesetConfig
  const Signatures* signatures = nullptr;
  // The URI, relative to the file, of a texture as the level shows it; `texture` is an index in Hierarchy::textures.
  std::function<std::string(std::uint32_t texture)> texture_uri;
  const TileAtlas* atlas = nullptr;  // of the cell, made with the same `morph`; may be null
  std::function<std::string(std::size_t image)> atlas_uri;
};

// One cell as binary glTF, the content of a tile. Positions are those of the cell, bit for bit: inside the unit cube, z
// up. The matrix of the one node scales them to the model's size around its origin and turns them y up, as glTF has it;
// copies of a vertex in several cells coincide under the same matrix. Vertices that no triangle uses are left out.
// Materials are those that the cell uses, or those of its atlas; textures are linked. `morph` adds the values of each
// vertex's parent as attributes (except for the root): _PARENT and _PARENTNORMAL, in the same coordinates,
// _PARENTTEXCOORD and _PARENTCOLOR. With signatures vertices are in the order of theirs among Signatures::of(cell), and
// the mesh's extras have the number of vertices of each. The cell has triangles.
[[nodiscard]] std::vector<std::byte> encode_cell_glb(const Hierarchy& hierarchy, CellId cell,
                                                     const CellGlbConfig& config);

}  // namespace lodestone
