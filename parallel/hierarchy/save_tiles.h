// A hierarchy as a 3D Tiles tileset: one file per cell, written by all workers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/files/atomic_folder.h"
#include "core/hierarchy/model/hierarchy.h"
#include "core/hierarchy/tiles/tileset_tree.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct SaveTilesConfig {
  TilesetConfig tileset;                 // its signatures and images are found here
  const CancelFlag* cancel = nullptr;    // looked at between tiles; may be null
  std::function<void(double)> progress;  // gets the share done, one call at a time; may be empty
};

struct SavedTiles {
  std::uint64_t tiles = 0;      // with content
  std::uint64_t tilesets = 0;   // JSON files
  std::uint64_t textures = 0;   // image files
  std::uint64_t triangles = 0;  // of all tiles
  std::uint64_t draws = 0;      // of all tiles: parts of one material
  std::uint64_t atlases = 0;    // tiles whose materials share images
  std::uint64_t bytes = 0;      // of all files
  std::vector<std::string> warnings;
};

// Writes the files that core/hierarchy/tiles/tileset_tree.h lists into the folder, which is not committed. The same
// bytes for any number of workers. Throws FileError when a file cannot be written, ResourceError for a cell of more
// than 4 GiB, Cancelled. Working memory: one tile per worker, the decoded
// images of one level where there are many materials, and the JSON.
[[nodiscard]] SavedTiles save_tiles(const Hierarchy& hierarchy, AtomicFolder& folder, Scheduler& scheduler,
                                    const SaveTilesConfig& config = {});

}  // namespace lodestone
