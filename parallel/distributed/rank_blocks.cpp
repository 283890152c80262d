#include "parallel/distributed/rank_blocks.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "parallel/distributed/cell_message.h"
#include "parallel/distributed/messages/pieces.h"
#include "parallel/hierarchy/build_blocks.h"

namespace lodestone {
namespace {

// Blocks of one level run, the others do not exist here.
class OneLevel final : public CellStorage {
 public:
  OneLevel(const BlockPlan& plan, int level) : plan_(plan), level_(level) {}
  [[nodiscard]] bool is_done(std::uint32_t block) const override { return plan_.blocks[block].level != level_; }

 private:
  const BlockPlan& plan_;
  int level_;
};

// Runs the rank's blocks of a level: completes its cells, and returns the coarser ones.
CellPart run_blocks(CellPart& part, int level, const BlockSetting& setting, Ranks& ranks, Scheduler& scheduler) {
  if (part.codes.empty()) return {};
  const BlockPlan plan = plan_blocks(part.codes, level, grids_of(setting.config));
  const auto l = static_cast<std::size_t>(level);
  std::vector<std::vector<CellBuild>> cells(l + 1);
  cells[l] = std::move(part.cells);
  cells[l - 1].resize(plan.levels[l - 1].codes.size());
  OneLevel storage(plan, level);
  BuildConfig config = setting.config;
  config.strategy = Strategy::levels;
  std::uint64_t triangles = 0;
  for (const CellBuild& cell : cells[l]) triangles += cell.slab.triangles.size();
  // The share is that of all levels, which take 4/3 of the work of the finest one alone. Ranks have about as much to do
  // as each other, so that this one stands for all.
  config.progress = [&](double share) { ranks.done(std::min(1.0, share * 4 / 3)); };
  build_blocks({plan, cells, storage, setting.attributes, setting.lattice, triangles,
                static_cast<std::size_t>(scheduler.workers())},
               config, scheduler);
  part.cells = std::move(cells[l]);
  return {plan.levels[l - 1].codes, std::move(cells[l - 1])};
}

CellPart sorted(CellPart&& part) {
  std::vector<std::uint32_t> order(part.codes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::uint32_t i) { return part.codes[i]; });
  CellPart out;
  for (const std::uint32_t i : order) {
    out.codes.push_back(part.codes[i]);
    out.cells.push_back(std::move(part.cells[i]));
  }
  return out;
}

// Cells go to the ranks that run their blocks.
CellPart exchange_cells(CellPart&& made, int level, const BlockSetting& setting, Ranks& ranks) {
  CellPart out;
  const auto keep = [&](CellCode code, CellBuild&& cell) {
    out.codes.push_back(code);
    out.cells.push_back(std::move(cell));
  };
  std::size_t next = 0;
  do {
    std::vector<Message> messages(static_cast<std::size_t>(ranks.count()));
    for (std::size_t bytes = 0; next < made.cells.size() && bytes < exchange_round_bytes; ++next) {
      CellBuild& cell = made.cells[next];
      const int owner = setting.owners.owner(made.codes[next], level);
      if (owner == ranks.rank()) {
        keep(made.codes[next], std::move(cell));
        continue;
      }
      Message& message = messages[static_cast<std::size_t>(owner)];
      const std::size_t before = message.size();
      append_cell(made.codes[next], cell, message);
      bytes += message.size() - before;
      cell = CellBuild();
    }
    for (const Message& message : ranks.exchange(std::move(messages)))
      for (CellReader reader(message, setting.attributes); !reader.at_end();) {
        CellBuild cell;
        const CellCode code = reader.read(cell);
        keep(code, std::move(cell));
      }
  } while (ranks.any(next < made.cells.size()));
  return sorted(std::move(out));
}

}  // namespace

std::vector<CellPart> build_rank_levels(CellPart&& finest, int level, const BlockSetting& setting, Ranks& ranks,
                                        Scheduler& scheduler) {
  std::vector<CellPart> levels(static_cast<std::size_t>(level) + 1);
  levels.back() = std::move(finest);
  for (int l = level; l > 0; --l) {
    const auto at = static_cast<std::size_t>(l);
    ranks.begin("building level " + std::to_string(l - 1));
    CellPart made = run_blocks(levels[at], l, setting, ranks, scheduler);
    levels[at - 1] = exchange_cells(std::move(made), l - 1, setting, ranks);
  }
  for (CellBuild& cell : levels.front().cells) cell.release_transient();
  return levels;
}

}  // namespace lodestone
