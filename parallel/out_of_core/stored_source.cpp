#include "parallel/out_of_core/stored_source.h"

#include <utility>

namespace lodestone {

std::vector<PayloadCounts> StoredSource::counts() const {
  std::vector<PayloadCounts> counts;
  for (std::size_t l = 0; l < cells_.size(); ++l)
    for (const StoredCell& cell : cells_[l]) counts.push_back(counts_of(cell, l > 0, tables().attributes));
  return counts;
}

// Cells of the next level find the new places in their parents.
void StoredSource::begin_level(std::size_t level) {
  level_ = level;
  parents_moved_ = std::move(moved_);
  moved_.assign(order_ == Order::for_compression ? cells_[level].size() : 0, {});
}

void StoredSource::visit(CellId id, const Visit& visit) {
  const CellRank rank = tables().levels[level_].rank_of(id);
  CellBuild build;
  store_.get_payload(cells_[level_][rank], level_ > 0, build);
  Cell cell = tables().cells[id];
  if (order_ == Order::for_compression) reorder(build, rank, cell.parent);
  view_payload(build, level_ > 0, cell);
  visit(cell);
}

void StoredSource::reorder(CellBuild& build, CellRank rank, CellId parent) {
  CellOrderScratch& scratch = scratch_[static_cast<std::size_t>(scheduler_.worker_index())];
  std::vector<std::uint32_t> moved = order_cell(build, scratch);
  if (level_ > 0) order_parents(build, moved, parents_moved_[tables().levels[level_ - 1].rank_of(parent)], scratch);
  if (level_ + 1 < cells_.size()) moved_[rank] = std::move(moved);
}

}  // namespace lodestone
