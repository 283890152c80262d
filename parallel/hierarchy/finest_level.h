// The cells of the finest level, from the partition.
#pragma once

#include <vector>

#include "core/hierarchy/construct/cell_build.h"
#include "parallel/hierarchy/partition.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Packs the partition's cells, all but the parents. partition.triangles may have moved to another owner: the cells keep
// looking at them. Same bytes for any number of workers. The partition is released, its positions before the shared
// vertices are described.
[[nodiscard]] std::vector<CellBuild> make_finest_cells(Partition&& partition, int level, float sigma0,
                                                       Scheduler& scheduler);

}  // namespace lodestone
