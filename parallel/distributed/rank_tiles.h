// A hierarchy as a 3D Tiles tileset, written by all ranks side by side: the same files as save_tiles.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "core/files/atomic_folder.h"
#include "core/mesh/up_axis.h"
#include "parallel/distributed/messages/ranks.h"
#include "parallel/hierarchy/save_tiles.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct RankTiles {
  std::uint64_t own_tiles = 0, own_triangles = 0;  // of this rank
  std::uint64_t finest_triangles = 0;              // of the model
  SavedTiles saved;                                // at rank 0: of all
};

struct RankTilesConfig {
  SaveTilesConfig tiles;
  std::optional<UpAxis> up;                            // not given: as the file says
  std::function<void(const RankTiles&)> last_words{};  // may be empty
};

// Called by all ranks: each writes the tiles of its cells (rank_cells.h). Rank 0 has the folder, on a disk that all
// machines share. Then all call last_words() with their own figures, for their last messages, and rank 0 writes
// what names the tiles; the folder is to be committed. Throws what load_lode and save_tiles throw, and UnsupportedError
// for `morph` of a file without signatures. Memory: the rank's cells and their parents, and what save_tiles takes.
[[nodiscard]] RankTiles save_rank_tiles(const std::filesystem::path& file, AtomicFolder* folder,
                                        const RankTilesConfig& config, Ranks& ranks, Scheduler& scheduler);

}  // namespace lodestone
