// A *family*: the children of one cell, which are drawn together or not at all. It is named by its parent's index; the
// root alone is the family no_cell.
#pragma once

#include <cstdint>

#include "core/hierarchy/lode/lode_payload.h"
#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// Indices in Hierarchy::cells.
struct FamilyCells {
  std::uint32_t begin = 0, end = 0;
};

[[nodiscard]] inline FamilyCells family_cells(const Hierarchy& hierarchy, std::uint32_t parent) {
  if (parent == no_cell) return {0, 1};
  const Cell& cell = hierarchy.cells[parent];
  return {cell.first_child, cell.first_child + cell.child_count};
}

// Leaves the cell as one whose arrays are not there.
inline void drop_arrays(Cell& cell) {
  visit_arrays(cell, {}, [](auto& array, std::uint32_t) { array = {}; });
}

}  // namespace lodestone
