// The cells and blocks that exist: the combinatorial part of a hierarchy, known before any vertex moves.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/id.h"
#include "core/hierarchy/construct/cell_build.h"

namespace lodestone {

struct LevelCells {
  std::vector<CellCode> codes;        // ascending
  std::vector<CellRank> parent;       // rank on the next coarser level; empty at the root
  std::vector<CellRank> first_child;  // one more than codes: children of c are [c], [c+1]); empty at L
};

// The cells of a level that are simplified together: those of coordinates [4k-2, 4k+2) on each axis. Their parents are
// the range [2k-1, 2k+1), so that eight siblings always share a block and no border plane coincides with one of the
// next level. Where parents are the same cells, they are those of coordinates [4k, 4k+4).
struct Block {
  int level = 0;                  // of the cells that it consumes; it makes cells of level - 1
  UsageBox range;                 // cell coordinates of `level`, both ends included
  std::vector<CellRank> parents;  // cells of level - 1, ascending; their children are the block's cells
};

struct BlockPlan {
  LevelGrids grids;
  std::vector<LevelCells> levels;          // [0] is the root
  std::vector<Block> blocks;               // finest level first, Morton order within a level
  std::vector<std::uint32_t> first_block;  // of each level l: [first_block[l], first_block[l] + count)
  std::vector<std::uint32_t> block_count;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> dependencies;  // (maker, consumer), each once
};

inline constexpr std::size_t most_parents = 64;  // of a block

// Coordinates k of the block that makes a cell: floor((2p + 2) / 4) on each axis, or floor(p / 4) where its only child
// is the same cell.
[[nodiscard]] constexpr CellCoord block_of_parent(CellCoord p, bool same_cells = false) {
  const auto k = [&](std::uint16_t v) { return static_cast<std::uint16_t>(same_cells ? v / 4 : (v + 1) / 2); };
  return {k(p.x), k(p.y), k(p.z)};
}

// `finest_codes`: the occupied cells of level `finest`, ascending, each once, not empty.
[[nodiscard]] BlockPlan plan_blocks(std::span<const CellCode> finest_codes, int finest, LevelGrids grids = {});

}  // namespace lodestone
