// The cells of the finest level, from the partition.
#pragma once

#include <functional>
#include <vector>

#include "core/hierarchy/construct/cell_build.h"
#include "parallel/hierarchy/partition.h"
#include "parallel/hierarchy/shared_vertices.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

using JoinShared = std::function<void(const FinestVertices&, SharedVertices&)>;

// Packs the partition's cells, all but the parents. partition.triangles may have moved to another owner: the cells keep
// looking at them. Same bytes for any number of workers. The partition is released, its positions before the shared
// vertices are described. `join`, if given, is called when all cells are added to the shared vertices: it may add what
// cells elsewhere know of them.
[[nodiscard]] std::vector<CellBuild> make_finest_cells(Partition&& partition, int grid, float sigma0,
                                                       Scheduler& scheduler, const JoinShared& join = {});

}  // namespace lodestone
