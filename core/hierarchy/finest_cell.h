// Packing one cell of the finest level from the triangles that the partition assigned to it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/cell_build.h"

namespace lodestone {

// What the partition knows about the vertices of the whole level.
struct FinestVertices {
  std::span<const Vec3f> positions;  // by input vertex
  // By input vertex: shared_flag | index into the two tables below, or anything without the flag for a vertex of one
  // cell.
  std::span<const std::uint32_t> sharing;
  std::span<const UsageBox> shared_usage;  // by shared index
  std::span<const Vec3f> shared_normals;   // by shared index; area-weighted sums, not normalised
  static constexpr std::uint32_t shared_flag = 0x8000'0000u;
};

// Working memory of make_finest_cell, reused between calls.
struct FinestCellScratch {
  std::vector<std::uint32_t> table_keys, table_values;  // open addressing: input vertex -> order of appearance
  std::vector<std::uint32_t> vertices, renumbered;
  std::vector<Vec3f> normals;
};

// Turns the triangles' input vertex ids into local ids *in place* and fills ids, usage, bounds, positions and normals.
// Vertices stand in order of appearance, those of one cell before the shared ones. Parents are left for the block.
void make_finest_cell(const FinestVertices& all, std::span<Triangle> triangles, CellBuild& cell,
                      FinestCellScratch& scratch);

}  // namespace lodestone
