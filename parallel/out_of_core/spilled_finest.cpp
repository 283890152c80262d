#include "parallel/out_of_core/spilled_finest.h"

#include <atomic>

namespace lodestone {

void SpilledFinest::describe_shared(Scheduler& scheduler, const std::function<void(std::uint64_t)>& progress,
                                    const std::function<void(SharedVertices&)>& join) {
  std::vector<SpilledFinestScratch> scratch(static_cast<std::size_t>(scheduler.workers()));
  std::atomic<std::uint64_t> seen{0};
  scheduler.for_chunks(cells_.codes.size(), 4, [&](ChunkRange range) {
    SpilledFinestScratch& s = scratch[static_cast<std::size_t>(scheduler.worker_index())];
    for (CellRank rank(range.begin); rank < range.end; ++rank) {
      s.triangles.resize(cells_.triangles_of(rank));
      CellBuild cell;
      collect_cell(cells_, rank, triangles_, s.triangles, s.numbers, cell);
      shared_.add(cell, cells_.codes[rank],
                  make_finest_cell(vertices_, cells_.codes[rank], config_.grid, config_.sigma0, cell, s.cell));
      seen += s.triangles.size();
    }
    if (progress) progress(seen);
  });
  if (join) join(shared_);
  shared_.finish(scheduler);
}

void SpilledFinest::make(CellRank rank, std::span<Triangle> room, SpilledFinestScratch& scratch,
                         CellBuild& cell) const {
  collect_cell(cells_, rank, triangles_, room, scratch.numbers, cell);
  (void)make_finest_cell(vertices_, cells_.codes[rank], config_.grid, config_.sigma0, cell, scratch.cell);
  shared_.describe(cell);
  cell.error = config_.lattice.error();  // the lattice has moved the input
}

}  // namespace lodestone
