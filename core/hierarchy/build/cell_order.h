// The order of vertices and triangles within a cell, which the hierarchy leaves free.
//
// Triangles that share an edge or a vertex follow each other and vertices are numbered by first use, so that the codecs
// of a compressed payload have little to say, and the caches of a graphics processor little to fetch again. Triangles
// of one material that stand together stay together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/build/cell_build.h"

namespace lodestone {

// Working memory, reused between calls.
struct CellOrderScratch {
  std::vector<Triangle> triangles;
  std::vector<std::byte> values;
};

// Reorders a finished cell in place; shared vertices stay behind the cell's own. Returns the new place of each vertex.
// The parents move with their vertices in order_parents. Depends on the cell alone.
[[nodiscard]] std::vector<std::uint32_t> order_cell(CellBuild& cell, CellOrderScratch& scratch);

// Moves the parents of a cell with its vertices and lets them name the new places in the parent cell.
void order_parents(CellBuild& cell, std::span<const std::uint32_t> moved, std::span<const std::uint32_t> parent_moved,
                   CellOrderScratch& scratch);

}  // namespace lodestone
