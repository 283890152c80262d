// Which rank has which cells and blocks: arithmetic on their coordinates and R - 1 numbers for each level, so that no
// rank needs a list of what the others have.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/model/cell_code.h"

namespace lodestone {

// Blocks of a level are dealt out as consecutive ranges of their Morton order, by the triangles of a sample that lie in
// them, and a cell is where its block is. So levels are shared out alike, as far as they have blocks; the root lies on
// the rank that makes it.
class CellOwners {
 public:
  // `sample`: cells of the finest level, as many of each as it should count for, in any order.
  CellOwners(int finest, const std::vector<CellCode>& sample, int ranks, LevelGrids grids = {});

  // The rank that runs the block to which a cell of this level belongs, and keeps the cell. At the root: of the one
  // cell.
  [[nodiscard]] int owner(CellCode cell, int level) const;

 private:
  [[nodiscard]] std::uint64_t key(CellCode cell, int level) const;

  LevelGrids grids_;
  std::vector<std::vector<std::uint64_t>> first_;  // by level: keys, by rank but the first
};

}  // namespace lodestone
