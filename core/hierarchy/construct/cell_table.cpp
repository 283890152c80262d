#include "core/hierarchy/construct/cell_table.h"

#include <algorithm>
#include <numeric>

#include "core/base/sort_unique.h"

namespace lodestone {
namespace {

// Parents on the next coarser level and the links to them.
LevelCells coarsen(LevelCells& fine, int level, LevelGrids grids) {
  LevelCells coarse;
  fine.parent.resize(fine.codes.size());
  for (CellRank c{0}; c < fine.codes.size(); ++c) {
    const CellCode parent = grids.parent(fine.codes[c], level);
    if (coarse.codes.empty() || coarse.codes.back() != parent) {
      coarse.codes.push_back(parent);
      coarse.first_child.push_back(c);
    }
    fine.parent[c] = CellRank(coarse.codes.size() - 1);
  }
  coarse.first_child.push_back(CellRank(fine.codes.size()));
  return coarse;
}

UsageBox block_range(CellCoord k, bool same_cells) {
  const int shift = same_cells ? 0 : 2;
  const auto lo = [&](std::uint16_t v) { return static_cast<std::uint16_t>(v == 0 ? 0 : 4 * v - shift); };
  const auto hi = [&](std::uint16_t v) { return static_cast<std::uint16_t>(4 * v + 3 - shift); };
  return {{lo(k.x), lo(k.y), lo(k.z)}, {hi(k.x), hi(k.y), hi(k.z)}};
}

// Blocks that consume level l, as groups of the parents on level l - 1.
void append_blocks(const LevelCells& parents, int level, bool same_cells, std::vector<Block>& out) {
  std::vector<std::pair<CellCode, CellRank>> keyed(parents.codes.size());
  for (CellRank p{0}; p < keyed.size(); ++p)
    keyed[p] = {CellCode::from(block_of_parent(parents.codes[p].coord(), same_cells)), p};
  std::sort(keyed.begin(), keyed.end());
  for (std::size_t i = 0; i < keyed.size(); ++i) {
    if (i == 0 || keyed[i].first != keyed[i - 1].first)
      out.push_back({level, block_range(keyed[i].first.coord(), same_cells), {}});
    out.back().parents.push_back(keyed[i].second);
  }
}

// A block of level l waits for the blocks of level l + 1 that make its cells.
void append_dependencies(BlockPlan& plan, int level) {
  const auto l = static_cast<std::size_t>(level);
  const LevelCells& cells = plan.levels[l];
  std::vector<std::uint32_t> maker(cells.codes.size());
  for (std::uint32_t b = plan.first_block[l + 1]; b < plan.first_block[l + 1] + plan.block_count[l + 1]; ++b)
    for (const CellRank made : plan.blocks[b].parents) maker[made] = b;
  for (std::uint32_t b = plan.first_block[l]; b < plan.first_block[l] + plan.block_count[l]; ++b) {
    std::vector<std::uint32_t> makers;
    for (const CellRank parent : plan.blocks[b].parents)
      for (CellRank c = plan.levels[l - 1].first_child[parent]; c < plan.levels[l - 1].first_child[parent + 1]; ++c)
        makers.push_back(maker[c]);
    sort_unique(makers);
    for (const std::uint32_t m : makers) plan.dependencies.emplace_back(m, b);
  }
}

}  // namespace

BlockPlan plan_blocks(std::span<const CellCode> finest_codes, int finest, LevelGrids grids) {
  const auto level_count = static_cast<std::size_t>(finest) + 1;
  BlockPlan plan;
  plan.grids = grids;
  plan.levels.resize(level_count);
  plan.levels.back().codes.assign(finest_codes.begin(), finest_codes.end());
  for (std::size_t l = level_count - 1; l > 0; --l)
    plan.levels[l - 1] = coarsen(plan.levels[l], static_cast<int>(l), grids);

  plan.first_block.assign(level_count, 0);
  plan.block_count.assign(level_count, 0);
  for (std::size_t l = level_count - 1; l > 0; --l) {
    plan.first_block[l] = static_cast<std::uint32_t>(plan.blocks.size());
    const auto level = static_cast<int>(l);
    append_blocks(plan.levels[l - 1], level, grids.keeps_cells(level), plan.blocks);
    plan.block_count[l] = static_cast<std::uint32_t>(plan.blocks.size()) - plan.first_block[l];
  }
  for (int l = finest - 1; l > 0; --l) append_dependencies(plan, l);
  return plan;
}

}  // namespace lodestone
