// Partition of the finest level: every triangle goes to the cell that contains its barycentre, in input order.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/finest_cell.h"
#include "parallel/scheduler.h"

namespace lodestone {

struct Partition {
  std::vector<CellCode> codes;                // occupied cells, ascending
  std::vector<std::uint64_t> first_triangle;  // of each cell; one more entry than codes
  std::vector<Triangle> triangles;            // by cell, input order within a cell; input vertex ids
  std::vector<Vec3f> positions;               // of the input
  // See FinestVertices: which vertices several cells use, the boxes of these cells, and their area-weighted normals.
  std::vector<std::uint32_t> sharing;
  std::vector<UsageBox> shared_usage;
  std::vector<Vec3f> shared_normals;
  std::uint64_t fingerprint = 0;  // sum of triangle_fingerprint over the triangles

  [[nodiscard]] FinestVertices vertices() const { return {positions, sharing, shared_usage, shared_normals}; }
};

// Consumes the mesh; level in [0, max_level]. About 40 bytes per triangle at its peak, the mesh included. The result is
// the same for any number of workers.
[[nodiscard]] Partition partition_mesh(IndexedMesh&& mesh, int level, Scheduler& scheduler);

// The level whose occupied cells hold on average about `cell_triangles` triangles, judged by a regular sample.
[[nodiscard]] int choose_finest_level(const IndexedMesh& mesh, std::uint32_t cell_triangles);

}  // namespace lodestone
