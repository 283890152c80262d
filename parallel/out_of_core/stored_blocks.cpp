#include "parallel/out_of_core/stored_blocks.h"

#include <algorithm>
#include <utility>

#include "parallel/out_of_core/journal.h"

namespace lodestone {

StoredBlocks::StoredBlocks(const BlockPlan& plan, const CellRuns& spilled, const SpilledFinest& finest,
                           CellStore& store, std::size_t lanes)
    : plan_(plan), spilled_(spilled), finest_(finest), store_(store), done_(plan.blocks.size(), 0), scratch_(lanes) {
  for (const LevelCells& level : plan.levels) {
    cells_.emplace_back(level.codes.size());
    stored_.emplace_back(level.codes.size());
  }
}

template <class Visit>
void StoredBlocks::for_children(const Block& block, const Visit& visit) const {
  const LevelCells& parents = plan_.levels[static_cast<std::size_t>(block.level) - 1];
  for (const CellRank parent : block.parents)
    for (CellRank c = parents.first_child[parent]; c < parents.first_child[parent + 1]; ++c) visit(c);
}

std::uint64_t StoredBlocks::largest_block(const BlockPlan& plan, const CellRuns& spilled) {
  std::uint64_t largest = 0;
  const std::size_t finest = plan.levels.size() - 1;
  if (finest == 0) return spilled.triangles_of(CellRank(0));
  for (std::uint32_t b = 0; b < plan.block_count[finest]; ++b) {
    std::uint64_t triangles = 0;
    for (const CellRank parent : plan.blocks[plan.first_block[finest] + b].parents)
      for (CellRank c = plan.levels[finest - 1].first_child[parent];
           c < plan.levels[finest - 1].first_child[parent + 1]; ++c)
        triangles += spilled.triangles_of(c);
    largest = std::max(largest, triangles);
  }
  return largest;
}

void StoredBlocks::store_root() {
  CellBuild root;
  std::vector<Triangle> triangles(spilled_.triangles_of(CellRank(0)));
  finest_.make(CellRank(0), triangles, scratch_.front(), root);
  store_.put(root, false, stored_.front().front());
}

void StoredBlocks::load(const Block& block, std::size_t lane) {
  const auto level = static_cast<std::size_t>(block.level);
  std::vector<CellBuild>& cells = cells_[level];
  if (level + 1 < plan_.levels.size())
    return for_children(block, [&](CellRank c) { store_.get_for_block(stored_[level][c], cells[c]); });
  std::uint64_t count = 0;
  for_children(block, [&](CellRank c) { count += spilled_.triangles_of(c); });
  SpilledFinestScratch& scratch = scratch_[lane];
  scratch.triangles.resize(count);
  std::span<Triangle> room = scratch.triangles;
  for_children(block, [&](CellRank c) {
    const std::uint64_t here = spilled_.triangles_of(c);
    finest_.make(c, room.first(here), scratch, cells[c]);
    room = room.subspan(here);
  });
}

void StoredBlocks::store(std::uint32_t index) {
  const Block& block = plan_.blocks[index];
  const auto level = static_cast<std::size_t>(block.level);
  for_children(block, [&](CellRank c) {
    CellBuild& cell = cells_[level][c];
    if (level + 1 == plan_.levels.size()) store_.put(cell, false, stored_[level][c]);
    store_.put_parents(cell, stored_[level][c]);
    cell = {};
  });
  for (const CellRank parent : block.parents) {
    CellBuild& cell = cells_[level - 1][parent];
    store_.put(cell, true, stored_[level - 1][parent]);
    cell = {};
  }
  if (record_) record(index);
}

void StoredBlocks::record(std::uint32_t index) const {
  const Block& block = plan_.blocks[index];
  const auto level = static_cast<std::size_t>(block.level);
  ByteWriter out;
  out.put(index);
  for_children(block, [&](CellRank c) { out.put(stored_[level][c]); });
  for (const CellRank parent : block.parents) out.put(stored_[level - 1][parent]);
  record_(out.bytes());
}

bool StoredBlocks::take_record(std::span<const std::byte> record) {
  if (record.size() < sizeof(std::uint32_t)) return false;
  ByteSource in(record);
  std::uint32_t index = 0;
  in.get(index);
  if (index >= plan_.blocks.size()) return false;
  const Block& block = plan_.blocks[index];
  std::size_t cells = block.parents.size();
  for_children(block, [&](CellRank) { ++cells; });
  if (record.size() != sizeof(index) + cells * sizeof(StoredCell)) return false;
  const auto level = static_cast<std::size_t>(block.level);
  for_children(block, [&](CellRank c) { in.get(stored_[level][c]); });
  for (const CellRank parent : block.parents) in.get(stored_[level - 1][parent]);
  done_[index] = 1;
  return true;
}

}  // namespace lodestone
