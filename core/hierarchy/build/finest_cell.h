// Packing one cell of the finest level from the triangles that the partition assigned to it.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/hierarchy/build/cell_build.h"
#include "core/math/float4.h"

namespace lodestone {

// What the partition knows about the vertices of the whole level.
struct FinestVertices {
  std::vector<Vec3f> positions;  // by input vertex
  // By input vertex: shared_flag | number among the shared ones, for a vertex that several cells use; anything without
  // the flag for a vertex of one cell.
  std::vector<std::uint32_t> sharing;
  std::size_t shared = 0;  // how many numbers there are
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
  std::vector<std::pair<std::uint32_t, std::uint32_t>> by_vertex;  // wedges: vertex, local id
};

// Takes a cell with `triangles`, whose local ids are in order of appearance, and `ids`, the input vertices that these
// stand for. Brings the vertices of one cell before the shared ones, and fills positions, shared ids, bounds, normals
// of the cell's own vertices and measure_cell's statistics. Usage and normals of the shared vertices are left for
// whoever sees the other cells, parents for the block.
//
// With wedges also vertex_ids; attributes are left for give_attributes.
//
// Returns what this cell's triangles add to the normals of the shared vertices, in the order of shared_ids: sums of
// cross products, so weighted by area. Valid until the next call.
[[nodiscard]] std::span<const Float4> make_finest_cell(const FinestVertices& all, int level, float sigma0,
                                                       CellBuild& cell, FinestCellScratch& scratch);

// Attributes of the cell's wedges, normals that the input has instead of those that are there; triangles of one
// material together. Once normals of shared vertices are known.
void give_attributes(const FinestVertices& all, CellBuild& cell);

}  // namespace lodestone
