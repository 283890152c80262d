#include "parallel/distributed/cell_owners.h"

#include <algorithm>

#include "core/hierarchy/construct/cell_table.h"

namespace lodestone {

CellOwners::CellOwners(int finest, std::vector<CellCode> sample, int ranks, LevelGrids grids)
    : finest_(finest), grids_(grids) {
  std::vector<std::uint64_t> keys;
  keys.reserve(sample.size());
  for (const CellCode cell : sample) keys.push_back(key(cell, finest));
  std::ranges::sort(keys);
  for (int r = 1; r < ranks; ++r)
    first_.push_back(keys.empty() ? 0
                                  : keys[keys.size() * static_cast<std::size_t>(r) / static_cast<std::size_t>(ranks)]);
}

int CellOwners::owner(CellCode cell, int level) const {
  return static_cast<int>(std::ranges::upper_bound(first_, key(cell, level)) - first_.begin());
}

// The Morton code of the block of the finest level in the middle of the cell's block.
std::uint64_t CellOwners::key(CellCode cell, int level) const {
  if (level == 0) return 0;
  const CellCoord block = block_of_parent(grids_.parent(cell, level).coord(), grids_.keeps_cells(level));
  return CellCode::from(block).morton << (3 * (grids_.of(finest_) - grids_.of(level)));
}

}  // namespace lodestone
