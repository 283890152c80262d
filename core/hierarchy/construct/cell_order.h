// Order of vertices and triangles within a cell, which the hierarchy does not prescribe.
//
// Triangles that share an edge or a vertex follow each other and vertices are numbered by first use, so that compressed
// payloads are small and the caches of a graphics processor are used well. Triangles of one material remain
// together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/construct/cell_build.h"

namespace lodestone {

// Working memory, reused between calls.
struct CellOrderScratch {
  std::vector<Triangle> triangles;
  std::vector<std::byte> values;
};

// Reorders a finished cell in place; shared vertices remain after the cell's own. Returns the new place of each vertex.
// order_parents moves the parents with their vertices. Depends on the cell alone.
[[nodiscard]] std::vector<std::uint32_t> order_cell(CellBuild& cell, CellOrderScratch& scratch);

// Moves the parents of a cell with its vertices and updates them to the new places in the parent cell.
void order_parents(CellBuild& cell, std::span<const std::uint32_t> moved, std::span<const std::uint32_t> parent_moved,
                   CellOrderScratch& scratch);

}  // namespace lodestone
