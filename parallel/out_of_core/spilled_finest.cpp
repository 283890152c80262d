#include "parallel/out_of_core/spilled_finest.h"

#include <atomic>

#include "parallel/build/shared_vertices.h"

namespace lodestone {

std::span<const Float4> SpilledFinest::pack(std::size_t rank, std::span<Triangle> triangles,
                                            SpilledFinestScratch& scratch, CellBuild& cell) const {
  cells_.read(file_, rank, triangles);
  scratch.numbers.clear(triangles.size());
  scratch.numbers.number(triangles, triangles.data());
  cell.triangles = triangles;
  cell.ids.assign(scratch.numbers.vertices().begin(), scratch.numbers.vertices().end());
  return make_finest_cell(vertices_, level_, sigma0_, cell, scratch.cell);
}

void SpilledFinest::describe_shared(Scheduler& scheduler, const std::function<void(std::uint64_t)>& done) {
  constexpr std::size_t vertex_grain = 1 << 16;
  UsageBoxes boxes(vertices_.shared);
  NormalSums normals(vertices_.shared);
  std::vector<SpilledFinestScratch> scratch(static_cast<std::size_t>(scheduler.workers()));
  std::atomic<std::uint64_t> seen{0};
  scheduler.for_chunks(cells_.codes.size(), 4, [&](ChunkRange range) {
    SpilledFinestScratch& s = scratch[static_cast<std::size_t>(scheduler.worker_index())];
    for (std::size_t rank = range.begin; rank < range.end; ++rank) {
      s.triangles.resize(cells_.triangles_of(rank));
      CellBuild cell;
      const auto sums = pack(rank, s.triangles, s, cell);
      for (std::size_t k = 0; k < sums.size(); ++k) {
        boxes.extend(shared_index(cell, k), cells_.codes[rank].coord());
        normals.add(shared_index(cell, k), sums[k]);
      }
      seen += s.triangles.size();
    }
    if (done) done(seen);
  });
  usage_.resize(vertices_.shared);
  normals_.resize(vertices_.shared);
  scheduler.for_chunks(vertices_.shared, vertex_grain, [&](ChunkRange range) {
    for (std::size_t i = range.begin; i < range.end; ++i) {
      usage_[i] = boxes.box(i);
      normals_[i] = pack_normal(normals.sum(i));
    }
  });
}

void SpilledFinest::make(std::size_t rank, std::span<Triangle> triangles, SpilledFinestScratch& scratch,
                         CellBuild& cell) const {
  (void)pack(rank, triangles, scratch, cell);
  cell.usage.resize(cell.slab.shared_ids.size());
  for (std::size_t k = 0; k < cell.usage.size(); ++k) {
    const std::size_t shared = shared_index(cell, k);
    cell.usage[k] = usage_[shared];
    cell.slab.normals[cell.first_shared() + k] = normals_[shared];
  }
  cell.error = lattice_.error();  // the lattice has moved the input
}

}  // namespace lodestone
