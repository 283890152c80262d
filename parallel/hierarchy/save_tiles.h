// A hierarchy as a 3D Tiles tileset: one file per cell, written by all workers, or by several writers in parts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
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
  friend bool operator==(const SavedTiles&, const SavedTiles&) = default;
};

// Writes the files that core/hierarchy/tiles/tileset_tree.h lists into the folder, which is not committed. The same
// bytes for any number of workers. Throws FileError when a file cannot be written, ResourceError for a cell of more
// than 4 GiB, Cancelled. Working memory: one tile per worker, the decoded
// images of one level where there are many materials, and the JSON.
[[nodiscard]] SavedTiles save_tiles(const Hierarchy& hierarchy, AtomicFolder& folder, Scheduler& scheduler,
                                    const SaveTilesConfig& config = {});

// The folders that tiles are written into.
void add_level_folders(const Hierarchy& hierarchy, AtomicFolder& folder);

// The same in parts: each writer writes some of the tiles, and one of them, which has heard of all others, what is
// left.
class TileWriter {
 public:
  // All outlive this but the config. The tables are those of all cells; payloads are needed of the cells that this
  // writes and of their parents. With `morph` signatures are needed, too, or all payloads.
  TileWriter(const Hierarchy& hierarchy, std::filesystem::path folder, Scheduler& scheduler, SaveTilesConfig config);
  TileWriter(const TileWriter&) = delete;
  TileWriter& operator=(const TileWriter&) = delete;
  ~TileWriter();

  // The level folders are there. The share of progress is of these cells. Throws as save_tiles does.
  void write_tiles(std::span<const CellId> cells);
  // All that another writer has to know of those tiles, for hear().
  [[nodiscard]] std::string tell() const;
  // Throws Error for anything else.
  void hear(const std::string& told);
  // Images that tiles link, and tilesets. `folder` is the one above. Throws as save_tiles does.
  [[nodiscard]] SavedTiles write_rest(AtomicFolder& folder);

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace lodestone
