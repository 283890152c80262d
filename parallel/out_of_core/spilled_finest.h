// Cells of the finest level made from spilled triangles, one at a time: the same bytes as make_finest_cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/files/scratch_file.h"
#include "core/hierarchy/build/cell_build.h"
#include "core/hierarchy/build/finest_cell.h"
#include "core/hierarchy/model/vertex_numbers.h"
#include "parallel/out_of_core/spill.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// One worker's memory.
struct SpilledFinestScratch {
  std::vector<Triangle> triangles;
  VertexNumbers numbers;
  FinestCellScratch cell;
};

class SpilledFinest {
 public:
  // vertices.sharing is numbered (number_shared). All of it stays as it is.
  SpilledFinest(const SpilledCells& cells, const ScratchFile& file, const FinestVertices& vertices, int level,
                float sigma0, Lattice lattice)
      : cells_(cells), file_(file), vertices_(vertices), level_(level), sigma0_(sigma0), lattice_(lattice) {}

  // Adds up what the cells know of the vertices that they share: once, before any cell is made. Memory: 52 bytes per
  // shared vertex at the peak, 16 afterwards. `done` is called with how many triangles have been looked at, from time
  // to time, from any thread.
  void describe_shared(Scheduler& scheduler, const std::function<void(std::uint64_t)>& done = {});
  static constexpr std::uint64_t peak_bytes_per_shared = 52, bytes_per_shared = 16;

  // The cell but for parents. Its triangles lie in `triangles`, as many as there are.
  void make(std::size_t rank, std::span<Triangle> triangles, SpilledFinestScratch& scratch, CellBuild& cell) const;

 private:
  // All that the cell's own triangles tell; see make_finest_cell.
  std::span<const Float4> pack(std::size_t rank, std::span<Triangle> triangles, SpilledFinestScratch& scratch,
                               CellBuild& cell) const;
  [[nodiscard]] std::size_t shared_index(const CellBuild& cell, std::size_t k) const {
    return vertices_.sharing[cell.slab.shared_ids[k]] & ~FinestVertices::shared_flag;
  }

  const SpilledCells& cells_;
  const ScratchFile& file_;
  const FinestVertices& vertices_;
  int level_;
  float sigma0_;
  Lattice lattice_;
  std::vector<UsageBox> usage_;        // by number among the shared vertices
  std::vector<PackedNormal> normals_;  // likewise
};

}  // namespace lodestone
