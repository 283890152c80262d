// Which rank has which cells and blocks: arithmetic on their coordinates and R - 1 numbers, so that no rank needs a
// list of what the others have.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/model/cell_code.h"

namespace lodestone {

// Blocks of the finest level are dealt out as consecutive ranges of their Morton order, and a cell of the finest level
// is where its block is. A block of a coarser level is where the block of the finest level in its middle is, whether
// there is one or not: so coarse levels lie on fewer and fewer ranks, and the root on one.
class CellOwners {
 public:
  // `sample`: cells of the finest level, as many of each as it should count for, in any order.
  CellOwners(int finest, std::vector<CellCode> sample, int ranks, LevelGrids grids = {});

  // The rank that runs the block to which a cell of this level belongs, and keeps the cell. At the root: of the one
  // cell.
  [[nodiscard]] int owner(CellCode cell, int level) const;

 private:
  [[nodiscard]] std::uint64_t key(CellCode cell, int level) const;

  int finest_;
  LevelGrids grids_;
  std::vector<std::uint64_t> first_;  // keys: by rank but the first
};

}  // namespace lodestone
