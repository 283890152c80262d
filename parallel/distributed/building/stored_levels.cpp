#include "parallel/distributed/building/stored_levels.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "parallel/distributed/cell_message.h"
#include "parallel/hierarchy/build_blocks.h"

namespace lodestone {
namespace {

// The blocks of one level, the cells of which are in the store, or made of `finest` if it is given.
class StoredLevelBlocks final : public CellStorage {
 public:
  StoredLevelBlocks(const BlockPlan& plan, StoredPart& part, const StoredFinest* finest, CellStore& store,
                    std::size_t lanes)
      : plan_(plan), level_(plan.levels.size() - 1), part_(part), finest_(finest), store_(store), scratch_(lanes) {
    cells_.resize(plan.levels.size());
    cells_[level_].resize(part.codes.size());
    cells_[level_ - 1].resize(plan.levels[level_ - 1].codes.size());
    made_ = {plan.levels[level_ - 1].codes, std::vector<StoredCell>(cells_[level_ - 1].size())};
    done_.resize(plan.blocks.size());
    for (std::size_t b = 0; b < done_.size(); ++b) done_[b] = !is_here(plan.blocks[b]);
  }

  // Takes the blocks that are kept, which are not run again, and keeps those that run.
  void keep(KeptBlocks& kept) {
    kept_ = &kept;
    for (std::size_t b = 0; b < done_.size(); ++b) {
      if (done_[b]) continue;
      const KeptBlock* block = kept.find(static_cast<int>(level_), first_child(plan_.blocks[b]));
      if (!block || block->children.size() != children_of(plan_.blocks[b]) ||
          block->parents.size() != plan_.blocks[b].parents.size())
        continue;
      auto child = block->children.begin();
      for_children(plan_.blocks[b], [&](CellRank c) { part_.cells[c] = *child++; });
      auto parent = block->parents.begin();
      for (const CellRank p : plan_.blocks[b].parents) made_.cells[p] = *parent++;
      done_[b] = true;
    }
  }

  [[nodiscard]] std::vector<std::vector<CellBuild>>& in_memory() { return cells_; }
  [[nodiscard]] StoredPart made() && { return std::move(made_); }

  [[nodiscard]] std::uint64_t largest() const {
    std::uint64_t largest = 0;
    for (const Block& block : plan_.blocks)
      if (is_here(block)) largest = std::max(largest, triangles_of(block));
    return largest;
  }

  [[nodiscard]] bool is_done(std::uint32_t block) const override { return done_[block] != 0; }
  void load(const Block& block, std::size_t lane) override {
    if (!finest_)
      return for_children(block, [&](CellRank c) { store_.get_for_block(part_.cells[c], cells_[level_][c]); });
    SpilledFinestScratch& scratch = scratch_[lane];
    scratch.triangles.resize(triangles_of(block));
    std::span<Triangle> room = scratch.triangles;
    for_children(block, [&](CellRank c) {
      const std::uint64_t here = finest_->cells().triangles_of(c);
      finest_->make(c, room.first(here), scratch, cells_[level_][c]);
      room = room.subspan(here);
    });
  }
  void store(std::uint32_t index) override {
    const Block& block = plan_.blocks[index];
    for_children(block, [&](CellRank c) {
      CellBuild& cell = cells_[level_][c];
      if (finest_) store_.put(cell, false, part_.cells[c]);
      store_.put_parents(cell, part_.cells[c]);
      cell = {};
    });
    for (const CellRank parent : block.parents) {
      CellBuild& cell = cells_[level_ - 1][parent];
      store_.put(cell, true, made_.cells[parent]);
      cell = {};
    }
    if (kept_) kept_->record(static_cast<int>(level_), first_child(block), kept_form(block));
  }

 private:
  [[nodiscard]] KeptBlock kept_form(const Block& block) const {
    KeptBlock out;
    for_children(block, [&](CellRank c) { out.children.push_back(part_.cells[c]); });
    for (const CellRank parent : block.parents) out.parents.push_back(made_.cells[parent]);
    return out;
  }
  [[nodiscard]] CellCode first_child(const Block& block) const {
    return part_.codes[plan_.levels[level_ - 1].first_child[block.parents.front()]];
  }
  [[nodiscard]] bool is_here(const Block& block) const { return static_cast<std::size_t>(block.level) == level_; }
  template <class Visit>
  void for_children(const Block& block, const Visit& visit) const {
    const LevelCells& parents = plan_.levels[level_ - 1];
    for (const CellRank parent : block.parents)
      for (CellRank c = parents.first_child[parent]; c < parents.first_child[parent + 1]; ++c) visit(c);
  }
  [[nodiscard]] std::size_t children_of(const Block& block) const {
    std::size_t count = 0;
    for_children(block, [&](CellRank) { ++count; });
    return count;
  }
  [[nodiscard]] std::uint64_t triangles_of(const Block& block) const {
    std::uint64_t count = 0;
    for_children(block,
                 [&](CellRank c) { count += finest_ ? finest_->cells().triangles_of(c) : part_.cells[c].triangles; });
    return count;
  }

  const BlockPlan& plan_;
  std::size_t level_;
  StoredPart& part_;
  const StoredFinest* finest_;
  CellStore& store_;
  std::vector<std::vector<CellBuild>> cells_;  // by level; empty except for those of the blocks at hand
  StoredPart made_;                            // of the next coarser level
  std::vector<std::uint8_t> done_;             // by block
  KeptBlocks* kept_ = nullptr;
  std::vector<SpilledFinestScratch> scratch_;  // by lane
};

std::uint64_t triangles_in(const StoredPart& part) {
  std::uint64_t count = 0;
  for (const StoredCell& cell : part.cells) count += cell.triangles;
  return count;
}

StoredPart sorted(const StoredPart& part) {
  std::vector<std::uint32_t> order(part.codes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return part.codes[i]; });
  StoredPart out;
  for (const std::uint32_t i : order) out.codes.push_back(part.codes[i]), out.cells.push_back(part.cells[i]);
  return out;
}

}  // namespace

StoredLevels::StoredLevels(std::unique_ptr<StoredFinest> finest, int level, const BlockSetting& setting,
                           const StoredSetting& stored, Ranks& ranks, Scheduler& scheduler)
    : stored_(stored),
      nameless_(stored.kept ? nullptr : ScratchFile::nameless(stored.memory.scratch())),
      store_(stored.kept ? stored.kept->cells() : *nameless_, {}),
      levels_(static_cast<std::size_t>(level) + 1) {
  if (stored.kept) stored.kept->settle(setting.owners, ranks);
  levels_.back().codes = finest->cells().codes;
  levels_.back().cells.resize(levels_.back().codes.size());
  if (level == 0 && !levels_.back().codes.empty()) {  // no block
    SpilledFinestScratch scratch;
    scratch.triangles.resize(finest->triangles());
    CellBuild root;
    finest->make(CellRank(0), scratch.triangles, scratch, root);
    store_.put(root, false, levels_.back().cells.front());
  }
  for (int l = level; l > 0; --l) {
    ranks.begin("building level " + std::to_string(l - 1));
    const StoredPart made = run_blocks(finest.get(), l, setting, ranks, scheduler);
    finest.reset();
    levels_[static_cast<std::size_t>(l) - 1] = exchange(made, l - 1, setting.owners, ranks);
  }
}

StoredPart StoredLevels::run_blocks(const StoredFinest* finest, int level, const BlockSetting& setting, Ranks& ranks,
                                    Scheduler& scheduler) {
  StoredPart& part = levels_[static_cast<std::size_t>(level)];
  if (part.codes.empty()) return {};
  const BlockPlan plan = plan_blocks(part.codes, level, grids_of(setting.config));
  StoredLevelBlocks blocks(plan, part, finest, store_, static_cast<std::size_t>(scheduler.workers()));
  if (stored_.kept) blocks.keep(*stored_.kept);
  if (finest) lanes_ = stored_.memory.lanes(finest->share_of(blocks.largest()));
  BuildConfig config = setting.config;
  config.strategy = Strategy::levels;
  config.progress = [&](double share) { ranks.done(std::min(1.0, share * 4 / 3)); };  // as in rank_blocks.cpp
  const std::uint64_t triangles = finest ? finest->triangles() : triangles_in(part);
  build_blocks({plan, blocks.in_memory(), blocks, {}, setting.lattice, triangles, lanes_}, config, scheduler);
  return std::move(blocks).made();
}

// Cells go to the ranks that run their blocks; those of this rank stay where they are in the file.
StoredPart StoredLevels::exchange(const StoredPart& made, int level, const CellOwners& owners, Ranks& ranks) {
  StoredPart out;
  std::size_t next = 0;
  do {
    std::vector<Message> messages(static_cast<std::size_t>(ranks.count()));
    for (std::size_t bytes = 0; next < made.cells.size() && bytes < exchange_round_bytes; ++next) {
      const int owner = owners.owner(made.codes[next], level);
      if (owner == ranks.rank()) {
        out.codes.push_back(made.codes[next]), out.cells.push_back(made.cells[next]);
        continue;
      }
      CellBuild cell;
      store_.get_for_block(made.cells[next], cell);
      Message& message = messages[static_cast<std::size_t>(owner)];
      const std::size_t before = message.size();
      append_cell(made.codes[next], cell, message);
      bytes += message.size() - before;
    }
    for (const Message& message : ranks.exchange(std::move(messages)))
      for (CellReader reader(message, AttributeSet{}); !reader.at_end();) {
        CellBuild cell;
        out.codes.push_back(reader.read(cell));
        store_.put(cell, true, out.cells.emplace_back());
      }
  } while (ranks.any(next < made.cells.size()));
  return sorted(out);
}

RankLevels::Summary StoredLevels::summary(std::size_t level, std::size_t index) const {
  const StoredCell& stored = levels_[level].cells[index];
  return {stored, stored.vertices, stored.shared, stored.triangles};
}

void StoredLevels::visit(std::size_t level, std::size_t index, const Visit& visit) const {
  CellBuild build;
  store_.get_payload(levels_[level].cells[index], level > 0, build);
  visit(build);
}

SharedBorder StoredLevels::border(std::size_t level, std::size_t index, BorderRoom& room) const {
  const StoredCell& cell = levels_[level].cells[index];
  store_.get_border(cell, room.positions, room.errors);
  return {room.positions, room.errors, cell.error};
}

std::uint64_t StoredLevels::compared_copies(std::uint64_t copies) const {
  std::uint64_t cells = 0;
  for (const StoredPart& part : levels_) cells += part.codes.size();
  return stored_.memory.compared_copies(cells, copies);
}

}  // namespace lodestone
