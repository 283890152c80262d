// Checks that the tables and payloads of a hierarchy are consistent, so that every index may be followed. The file
// reader and the verifier both begin with it.
#pragma once

#include <cstdint>
#include <string>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// The first fault of the level and cell tables, empty when there is none: levels that cut the cells into consecutive
// runs, one root, Morton order inside the grid, children consecutive and complete, finite boxes and bounds, counts that
// fit the cells, sigma0 and transform usable.
[[nodiscard]] std::string table_fault(const Hierarchy& hierarchy);

// The first fault of one cell's payload, nullptr when there is none: span sizes, finite positions, parents and triangle
// vertices in range, no degenerate triangle. The tables are valid.
[[nodiscard]] const char* payload_fault(const Hierarchy& hierarchy, CellId cell);
// The same for a cell that is not in the table (yet), whose parent cell has `parent_vertices`.
[[nodiscard]] const char* payload_fault(const Cell& cell, AttributeSet attributes, std::size_t parent_vertices);

}  // namespace lodestone
