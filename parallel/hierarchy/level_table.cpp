#include "parallel/hierarchy/level_table.h"

#include <algorithm>

namespace lodestone {

void append_level(const BlockPlan& plan, std::size_t l, const std::function<LevelEntry(CellRank)>& entry_of,
                  Hierarchy& out) {
  const LevelCells& table = plan.levels[l];
  Level level;
  level.first_cell = CellId(out.cells.size());
  level.cell_count = static_cast<std::uint32_t>(table.codes.size());
  const float h = out.cell_size(static_cast<int>(l));
  for (CellRank rank{0}; rank < table.codes.size(); ++rank) {
    const LevelEntry entry = entry_of(rank);
    const CellFigures& from = *entry.figures;
    Cell cell;
    cell.code = table.codes[rank];
    cell.parent = l > 0 ? out.levels.back().id_of(table.parent[rank]) : no_cell;
    if (!table.first_child.empty()) {
      cell.first_child = CellId(level.end_cell() + table.first_child[rank]);
      cell.child_count = table.first_child[rank + 1] - table.first_child[rank];
    }
    cell.bounds = from.bounds;
    cell.max_displacement = from.max_displacement;
    cell.error = from.error;
    level.triangles += entry.triangles;
    level.vertices += entry.vertices;
    for (std::size_t m = 0; m < level.reach.size(); ++m) level.reach[m] = std::max(level.reach[m], from.reach[m]);
    level.diameter = std::max(level.diameter, from.diameter);
    level.max_edge = std::max(level.max_edge, from.max_edge);
    level.long_edges += from.long_edges;
    level.error = std::max(level.error, from.error / h);  // exact, as h is a power of two
    out.cells.push_back(cell);
  }
  out.levels.push_back(level);
}

}  // namespace lodestone
