// Order of a cell's triangles by place: triangles that follow each other are near each other, so that a run of them has
// a small box and is culled on its own (render/culling/runs.h).
//
// Barycentres are sorted by the 8^3 boxes of the cell that they lie in, along a Hilbert curve through the boxes
// (skilling2004): Morton order would step across the cell. Cells of the finest level are sorted; coarser ones inherit
// the order, since their triangles are images of their children's, child by child.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/cell_code.h"
#include "core/math/lanes/float4.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Place of one of the 8^3 boxes of a cell on the curve, 0..511; coordinates below 8. Boxes that follow each other share
// a side.
[[nodiscard]] std::uint16_t curve_place(CellCoord box);

// Working memory, reused between calls.
using CompactOrderScratch = std::vector<std::uint16_t>;

// Writes the triangles of the cell to `sorted`, of the same size, which does not overlap them; those of one box in the
// order in which they came. Barycentres outside the cell count as in the nearest box. O(triangles).
void sort_compactly(std::span<const Triangle> triangles, std::span<const Float4> positions, CellCode code, int level,
                    std::span<Triangle> sorted, CompactOrderScratch& scratch);

}  // namespace lodestone
