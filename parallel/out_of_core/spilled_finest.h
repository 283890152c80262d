// Cells of the finest level made from spilled triangles, one at a time: the same bytes as make_finest_cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/hierarchy/construct/cell_build.h"
#include "core/hierarchy/construct/finest_cell.h"
#include "parallel/hierarchy/cell_runs.h"
#include "parallel/hierarchy/shared_vertices.h"
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
  struct Config {
    int grid = 0;
    float sigma0 = 0;
    Lattice lattice{};
  };
  // vertices.sharing is numbered (number_shared). All of them remain as they are.
  SpilledFinest(const CellRuns& cells, const TriangleSource& triangles, const FinestVertices& vertices,
                const Config& config)
      : cells_(cells), triangles_(triangles), vertices_(vertices), config_(config), shared_(vertices) {}

  // Adds up what the cells know of the vertices that they share: once, before any cell is made. `progress` is called
  // with how many triangles have been looked at, from time to time, from any thread. `join`, if given, is called when
  // all cells are added: it may add what cells elsewhere know.
  void describe_shared(Scheduler& scheduler, const std::function<void(std::uint64_t)>& progress = {},
                       const std::function<void(SharedVertices&)>& join = {});

  // Makes the cell without parents. Its triangles lie in `room`, as many as there are.
  void make(CellRank rank, std::span<Triangle> room, SpilledFinestScratch& scratch, CellBuild& cell) const;

 private:
  const CellRuns& cells_;
  const TriangleSource& triangles_;
  const FinestVertices& vertices_;
  Config config_;
  SharedVertices shared_;
};

}  // namespace lodestone
