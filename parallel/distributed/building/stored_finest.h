// The finest level of a rank from triangles in a scratch file: cells are made when a block needs them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/files/scratch_file.h"
#include "parallel/distributed/building/rank_memory.h"
#include "parallel/distributed/rank_finest.h"
#include "parallel/distributed/route_triangles.h"
#include "parallel/out_of_core/spill.h"
#include "parallel/out_of_core/spilled_finest.h"

namespace lodestone {

class StoredFinest {
 public:
  // As route_triangles, but the triangles that come are put into a file, and then by cells into another one. Consumes
  // the slices. Memory: 20 bytes per vertex of the rank's cells, a bit for each of the whole mesh, and a part of the
  // triangles.
  StoredFinest(const MeshStream& stream, CleanSlices&& clean, const FinestChoice& choice, const RankMemory& memory,
               Ranks& ranks, Scheduler& scheduler);

  // Adds up what the cells of all ranks know of the vertices that they share: before any is made.
  void share(const FinestChoice& choice, float sigma0, Ranks& ranks, Scheduler& scheduler);

  [[nodiscard]] const CellRuns& cells() const { return cells_; }
  [[nodiscard]] std::uint64_t triangles() const { return cells_.first_triangle.back(); }
  [[nodiscard]] RankMemory::FinestShare share_of(std::uint64_t largest_block) const;
  // Makes the cell without parents, with numbers of the whole mesh. Its triangles lie in `room`. From any thread.
  void make(CellRank cell, std::span<Triangle> room, SpilledFinestScratch& scratch, CellBuild& out) const;

 private:
  Lattice lattice_;
  Slices slices_;                              // of the numbers of vertices
  std::vector<std::uint32_t> ids_;             // by vertex of the rank: its number
  std::vector<std::uint32_t> outer_vertices_;  // that other ranks use, too, until their sums are added up
  FinestVertices vertices_;
  std::unique_ptr<ScratchFile> file_;
  CellRuns cells_;
  std::optional<FileSource> source_;
  std::optional<SpilledFinest> finest_;
};

}  // namespace lodestone
