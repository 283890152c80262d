// A hierarchy as a tileset of 3D Tiles 1.1 (OGC 22-025r4): a tile for each cell, which its children replace.
//
//   tileset.json | LEVEL/X_Y_Z.glb for each cell with triangles | textures/T.jpg, T_HALVINGS.jpg | LEVEL/X_Y_Z.json
//
// Large trees are cut: a tile whose content is another tileset (LEVEL/X_Y_Z.json) stands for a whole subtree.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

struct TilesetConfig {
  bool morph = false;             // whether tiles carry what a viewer needs to morph between levels
  std::size_t most_tiles = 4096;  // a tree of more is cut
  int levels_per_file = 5;        // of the subtrees that are cut off, at least 1: about 1400 tiles of a surface
};

struct TilesetFile {
  std::string path;  // from the folder of the tileset
  std::string json;
};

[[nodiscard]] std::string tile_path(const Hierarchy& hierarchy, std::uint32_t cell);

// The file of a texture as the level shows it.
[[nodiscard]] std::string texture_path(const Hierarchy& hierarchy, std::uint32_t texture, int level);

// How far a cell is from the model, in its unit: the measured error of the surface, or, when its textures are copies of
// lower resolution, the mean size of their texels on it where that is more. 0 on the finest level.
[[nodiscard]] double tile_error(const Hierarchy& hierarchy, std::uint32_t cell);

// The tileset.json, followed by those it refers to. `errors` has one value per cell; what is written does not decrease
// towards the root. Boxes lie in each other, grown by rounding errors. The root's transform is the origin of the model.
[[nodiscard]] std::vector<TilesetFile> encode_tilesets(const Hierarchy& hierarchy, std::span<const double> errors,
                                                       const TilesetConfig& config = {});

}  // namespace lodestone
