// Two passes over the cells: pack each from its own triangles, adding up what the cells know of a shared vertex; then
// give every copy of a shared vertex the sum.
#include "parallel/hierarchy/finest_level.h"

#include <utility>

namespace lodestone {

std::vector<CellBuild> make_finest_cells(Partition&& given, int grid, float sigma0, Scheduler& scheduler,
                                         const JoinShared& join) {
  constexpr std::size_t cell_grain = 16;
  Partition partition = std::move(given);
  SharedVertices shared(partition.vertices);
  std::vector<FinestCellScratch> scratch(static_cast<std::size_t>(scheduler.workers()));
  scheduler.for_chunks(partition.cells.size(), cell_grain, [&](ChunkRange range) {
    FinestCellScratch& s = scratch[static_cast<std::size_t>(scheduler.worker_index())];
    for (std::size_t c = range.begin; c < range.end; ++c)
      shared.add(partition.cells[c], partition.codes[c],
                 make_finest_cell(partition.vertices, partition.codes[c], grid, sigma0, partition.cells[c], s));
  });
  std::vector<Vec3f>().swap(partition.vertices.positions);
  if (join) join(partition.vertices, shared);
  shared.finish(scheduler);
  scheduler.for_chunks(partition.cells.size(), cell_grain, [&](ChunkRange range) {
    for (std::size_t c = range.begin; c < range.end; ++c) {
      shared.describe(partition.cells[c]);
      if (partition.vertices.attributes.wedges) give_attributes(partition.vertices, partition.cells[c]);
    }
  });
  return std::move(partition.cells);
}

}  // namespace lodestone
