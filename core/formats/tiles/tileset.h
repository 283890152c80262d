// 3D Tiles (OGC 18-053r2 and 22-025r4): trees of tiles, each a model of its own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/files/byte_reader.h"
#include "core/formats/common/read_config.h"
#include "core/math/affine.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

struct Tile {
  std::filesystem::path file;
  std::optional<std::filesystem::path> limit;  // as in CompanionFolder: that of the tileset
  Affine3d map;                                // from the model, z up, to the coordinates of the root's parent
  Affine3d up_to_z;                            // turns the model's up axis to z before
  std::string reference;                       // file and place that name it
};

struct TileList {
  std::vector<Tile> tiles;  // in the order of the tree
  std::vector<std::string> warnings;
};

// The tiles that make up the finest surface: with refinement REPLACE those with content and without a descendant that
// has content, with ADD all. External tilesets are followed. Throws InputError for a malformed tileset or
// one that refers to itself or to others over and over, FileError for a file that is missing or outside of the limit,
// UnsupportedError for implicit tiling. Point clouds, instanced models and composites are left out with a warning.
[[nodiscard]] TileList list_tiles(ByteReader& input);

// The up axis of tiles that are put together as a mesh: where it lies on the Earth, away from the middle of that;
// elsewhere z, in the coordinates of the root's parent.
[[nodiscard]] Up up_of_tiles(const Box3d& box);

// All of them as one mesh, in the coordinates of the root, usually on the Earth.
[[nodiscard]] RawMesh read_tileset(ByteReader& input, const ReadConfig& config = {});

// A tile as a mesh in the coordinates of the root's parent: glTF, or one wrapped as Batched 3D Model (.b3dm).
[[nodiscard]] RawMesh read_tile(const Tile& tile, const ReadConfig& config);

}  // namespace lodestone
