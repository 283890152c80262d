#include "parallel/distributed/building/stored_finest.h"

#include <utility>

#include "parallel/distributed/building/received_triangles.h"
#include "parallel/mesh/vertex_sharing.h"

namespace lodestone {

StoredFinest::StoredFinest(const MeshStream& stream, CleanSlices&& given, const FinestChoice& choice,
                           const RankMemory& memory, Ranks& ranks, Scheduler& scheduler)
    : lattice_(given.transform.lattice), slices_(given.vertices_left), file_(ScratchFile::nameless(memory.scratch())) {
  CleanSlices clean = std::move(given);
  ranks.begin("sorting");
  ReceivedTriangles received(memory.scratch(), ranks.count(), slices_.total());
  exchange_triangles(stream, clean, choice, ranks, [&](const ByRank<Triangle>& came) { received.append(came); });
  ids_ = received.finish();

  // Positions wait in a file until those of the slice are released, so that they are in memory once.
  const std::unique_ptr<ScratchFile> waiting = ScratchFile::nameless(memory.scratch());
  vertices_.sharing.reserve(ids_.size());
  fetch_vertices(
      std::move(clean), ids_, ranks,
      {[&](std::span<const Vec3f> some) { waiting->write_at(waiting->claim(some.size_bytes()), std::as_bytes(some)); },
       [&](std::span<const std::uint8_t> some) {
         for (const std::uint8_t used_by_others : some) {
           if (used_by_others) outer_vertices_.push_back(static_cast<std::uint32_t>(vertices_.sharing.size()));
           vertices_.sharing.push_back(used_by_others ? unowned | FinestVertices::shared_flag : unowned);
         }
       }});
  CleanStream all;
  all.positions.resize(ids_.size());
  waiting->read_at(0, std::as_writable_bytes(std::span(all.positions)));
  all.triangles = received.triangle_count();
  all.dropped = BitSet(all.triangles);
  received.set_positions(all.positions);
  ranks.begin("sorting by cells");
  const SpillConfig config{choice.grid, memory.part(ids_.size(), all.triangles), [&](std::uint64_t done) {
                             ranks.done(static_cast<double>(done) / static_cast<double>(all.triangles));
                           }};
  cells_ = spill_triangles(received, all, config, vertices_.sharing, *file_, scheduler);
  vertices_.positions = std::move(all.positions);
  vertices_.shared = number_shared(vertices_.sharing, scheduler);
}

void StoredFinest::share(const FinestChoice& choice, float sigma0, Ranks& ranks, Scheduler& scheduler) {
  source_.emplace(*file_);
  finest_.emplace(cells_, *source_, vertices_, SpilledFinest::Config{choice.grid, sigma0, lattice_});
  OuterVertices outer;
  outer.reserve(outer_vertices_.size());
  for (const std::uint32_t v : outer_vertices_) outer.emplace_back(ids_[v], v);  // both ascend
  finest_->describe_shared(scheduler, {},
                           [&](SharedVertices& shared) { join_shared(outer, vertices_, slices_, shared, ranks); });
  std::vector<std::uint32_t>().swap(outer_vertices_);
}

RankMemory::FinestShare StoredFinest::share_of(std::uint64_t largest_block) const {
  return {.vertices = ids_.size(),
          .shared = vertices_.shared,
          .outer = outer_vertices_.size(),
          .cells = cells_.codes.size(),
          .runs = cells_.runs.size(),
          .largest_block = largest_block};
}

void StoredFinest::make(CellRank cell, std::span<Triangle> room, SpilledFinestScratch& scratch, CellBuild& out) const {
  finest_->make(cell, room, scratch, out);
  for (std::uint32_t& id : out.ids) id = ids_[id];
  for (std::uint32_t& id : out.slab.shared_ids) id = ids_[id];
}

}  // namespace lodestone
