// Packs one cell of the finest level from the triangles that the partition assigned to it.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/hierarchy/construct/cell_build.h"
#include "core/hierarchy/construct/compact_order.h"
#include "core/math/lanes/float4.h"

namespace lodestone {

// The vertices of the whole level, from the partition.
struct FinestVertices {
  std::vector<Vec3f> positions;  // by input vertex
  // By input vertex: shared_flag | number among the shared ones for a vertex that several cells use; any value without
  // the flag for a vertex of one cell.
  std::vector<std::uint32_t> sharing;
  std::size_t shared = 0;  // number of shared vertices
  // With wedges the above is by input wedge: wedges of one vertex share a number.
  AttributeSet attributes{};
  WedgeAttributes wedges{};
  static constexpr std::uint32_t shared_flag = 0x8000'0000u;
};

// Working memory of make_finest_cell, reused between calls.
struct FinestCellScratch {
  std::vector<std::uint32_t> renumbered;  // by order of appearance
  std::vector<std::uint32_t> shared;      // the shared ones, in order of appearance
  std::vector<std::uint32_t> ids;
  std::vector<Float4> positions, normals;
  std::vector<Triangle> triangles;  // before they are sorted
  CompactOrderScratch boxes;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> by_vertex;  // wedges: vertex, local id
};

// The cell has `triangles`, whose local ids are in order of appearance, and `ids`, the input vertices of these. Moves
// the vertices of this cell alone before the shared ones, sorts the triangles compactly, and fills positions, shared
// ids, bounds, normals of the cell's own vertices and measure_cell's statistics. Usage and normals of the shared
// vertices need the other cells, parents the block.
//
// With wedges it also fills vertex_ids; give_attributes fills the attributes.
//
// Returns the contributions of this cell's triangles to the normals of the shared vertices, in the order of shared_ids:
// sums of cross products, so weighted by area. Valid until the next call.
[[nodiscard]] std::span<const Float4> make_finest_cell(const FinestVertices& all, CellCode code, int grid, float sigma0,
                                                       CellBuild& cell, FinestCellScratch& scratch);

// Fills the attributes of the cell's wedges, replaces normals by those of the input, and groups triangles by material.
// Called when the normals of shared vertices are known.
void give_attributes(const FinestVertices& all, CellBuild& cell);

}  // namespace lodestone
