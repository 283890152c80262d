#include "parallel/distributed/cell_owners.h"

#include <algorithm>

#include "core/hierarchy/construct/cell_table.h"

namespace lodestone {
namespace {

struct Weighted {
  std::uint64_t code = 0, weight = 0;
};

// Ascending by code, with the weights of equal ones added up.
void join_equal(std::vector<Weighted>& items) {
  std::ranges::sort(items, {}, &Weighted::code);
  std::size_t kept = 0;
  for (const Weighted& item : items)
    if (kept > 0 && items[kept - 1].code == item.code)
      items[kept - 1].weight += item.weight;
    else
      items[kept++] = item;
  items.resize(kept);
}

// By rank but the first: the code from which on its items are, so that each has as near as possible to the same weight.
std::vector<std::uint64_t> cut(const std::vector<Weighted>& items, int ranks) {
  std::vector<std::uint64_t> before{0};  // by item
  for (const Weighted& item : items) before.push_back(before.back() + item.weight);
  std::vector<std::uint64_t> first;
  std::size_t at = 0;
  for (std::uint64_t r = 1; r < static_cast<std::uint64_t>(ranks); ++r) {
    const std::uint64_t wanted = before.back() * r / static_cast<std::uint64_t>(ranks);
    while (at < items.size() && before[at + 1] <= wanted) ++at;
    const bool up = at < items.size() && wanted - before[at] > before[at + 1] - wanted;
    const std::size_t item = at + (up ? 1 : 0);
    first.push_back(item < items.size() ? items[item].code : before.back() > 0 ? items.back().code + 1 : 0);
  }
  return first;
}

}  // namespace

CellOwners::CellOwners(int finest, const std::vector<CellCode>& sample, int ranks, LevelGrids grids)
    : grids_(grids), first_(static_cast<std::size_t>(finest) + 1) {
  std::vector<Weighted> cells, blocks;
  for (const CellCode cell : sample) cells.push_back({cell.morton, 1});
  for (int level = finest; level >= 0; --level) {
    join_equal(cells);
    blocks.clear();
    for (const Weighted& cell : cells) blocks.push_back({key({cell.code}, level), cell.weight});
    join_equal(blocks);
    first_[static_cast<std::size_t>(level)] = cut(blocks, ranks);
    for (Weighted& cell : cells) cell.code = grids.parent({cell.code}, level).morton;
  }
}

int CellOwners::owner(CellCode cell, int level) const {
  const std::vector<std::uint64_t>& first = first_[static_cast<std::size_t>(level)];
  return static_cast<int>(std::ranges::upper_bound(first, key(cell, level)) - first.begin());
}

// The Morton code of the cell's block.
std::uint64_t CellOwners::key(CellCode cell, int level) const {
  if (level == 0) return 0;
  return CellCode::from(block_of_parent(grids_.parent(cell, level).coord(), grids_.keeps_cells(level))).morton;
}

}  // namespace lodestone
