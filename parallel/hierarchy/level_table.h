// The finished tables of one level: its cells, linked to those of the next coarser one, and the level's statistics.
#pragma once

#include <cstddef>
#include <functional>

#include "core/hierarchy/construct/cell_build.h"
#include "core/hierarchy/construct/cell_table.h"

namespace lodestone {

struct LevelEntry {
  const CellFigures* figures = nullptr;
  std::uint64_t vertices = 0, triangles = 0;
};

// Appends level l of the plan to out.levels and out.cells, coarse levels first; statistics are the cells' in cell
// order. The views of the payloads are left empty.
void append_level(const BlockPlan& plan, std::size_t l, const std::function<LevelEntry(CellRank)>& entry_of,
                  Hierarchy& out);

}  // namespace lodestone
