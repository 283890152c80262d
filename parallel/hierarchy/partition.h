// Partition of the finest level: every triangle goes to the cell that contains its barycentre, in input order.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/hierarchy/construct/cell_build.h"
#include "core/hierarchy/construct/finest_cell.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct Partition {
  std::vector<CellCode> codes;      // occupied cells, ascending
  std::vector<Triangle> triangles;  // by cell, input order within a cell; local ids, see `cells`
  // By code, with `triangles` and `ids` alone: the cell's part of the triangles above, and the input vertices that
  // their local ids stand for, in order of appearance.
  std::vector<CellBuild> cells;
  FinestVertices vertices;        // of the input
  std::uint64_t fingerprint = 0;  // sum of triangle_fingerprint over the triangles
};

[[nodiscard]] AttributeSet attributes_of(const IndexedMesh& mesh);

// Numbers the flagged vertices anew, by the flags of vertices, and gives all their wedges the same.
void number_shared_vertices(FinestVertices& vertices, Scheduler& scheduler);

// Consumes the mesh; level in [0, max_level]. The result is the same for any number of workers. Memory at the peak, for
// V vertices and T triangles, the mesh included: 22 V + 24 T bytes, 35 per triangle when V = T / 2, and 40 bytes for
// each cell that each 65536 consecutive triangles lie in: little, unless the triangles come in random order.
[[nodiscard]] Partition partition_mesh(IndexedMesh&& mesh, int level, Scheduler& scheduler);

// The level whose occupied cells hold on average about `cell_triangles` triangles, judged by a regular sample.
[[nodiscard]] int choose_finest_level(const IndexedMesh& mesh, std::uint32_t cell_triangles);

// The two halves of it: every how many triangles, from the first, one is looked at; and the choice by the cells of
// max_level that hold the barycentres of those. Or by occupied(level), the number of cells of a level that hold any of
// the `sampled` ones: it is asked from level 0 on, as far as it needs to be.
[[nodiscard]] std::size_t level_sample_stride(std::size_t triangles);
[[nodiscard]] int finest_level_of(std::span<const CellCode> sample, std::size_t triangles,
                                  std::uint32_t cell_triangles);
[[nodiscard]] int finest_level_of(const std::function<std::size_t(int level)>& occupied, std::size_t sampled,
                                  std::size_t triangles, std::uint32_t cell_triangles);

}  // namespace lodestone
