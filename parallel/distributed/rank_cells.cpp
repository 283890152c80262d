#include "parallel/distributed/rank_cells.h"

#include <algorithm>
#include <numeric>

#include "core/base/sort_unique.h"
#include "core/hierarchy/lode/lode_payload.h"
#include "parallel/streaming/cell_stream.h"

namespace lodestone {
namespace {

// By their parents, in the order of the file.
std::vector<CellId> all_families(const Hierarchy& tables) {
  std::vector<CellId> families{no_cell};
  for (CellId c{0}; c < tables.cells.size(); ++c)
    if (tables.cells[c].child_count > 0) families.push_back(c);
  return families;
}

// By family: the rank in whose equal part of all bytes its middle is.
std::vector<std::int32_t> owners_of(const std::vector<CellId>& families, int ranks, const CellStream& stream) {
  std::vector<std::uint64_t> end;
  for (const CellId family : families) end.push_back((end.empty() ? 0 : end.back()) + stream.family_bytes(family));
  std::vector<std::int32_t> owners;
  for (std::size_t i = 0; i < families.size(); ++i) {
    const double middle = 0.5 * (static_cast<double>(i == 0 ? 0 : end[i - 1]) + static_cast<double>(end[i]));
    owners.push_back(std::min(static_cast<int>(middle / static_cast<double>(end.back()) * ranks), ranks - 1));
  }
  return owners;
}

}  // namespace

RankCells load_rank_cells(const std::filesystem::path& file, int rank, int ranks, Scheduler& scheduler) {
  const CellStream stream(file);
  RankCells cells;
  cells.hierarchy = stream.tables();
  Hierarchy& hierarchy = cells.hierarchy;
  const std::vector<CellId> all = all_families(hierarchy);
  const std::vector<std::int32_t> owners = owners_of(all, ranks, stream);
  cells.owner_of.resize(hierarchy.cells.size());
  std::vector<CellId> families;  // own ones, and those that have their parents
  for (std::size_t i = 0; i < all.size(); ++i) {
    const FamilyCells range = family_cells(hierarchy, all[i]);
    for (CellId c = range.begin; c < range.end; ++c) {
      cells.owner_of[c] = owners[i];
      if (owners[i] == rank) cells.own.push_back(c);
    }
    if (owners[i] != rank) continue;
    families.push_back(all[i]);
    if (all[i] != no_cell) families.push_back(hierarchy.cells[all[i]].parent);
  }
  sort_unique(families);
  cells.memory.resize(families.size());
  scheduler.for_chunks(families.size(), 1, [&](ChunkRange chunk) {
    LoadedFamily loaded = stream.load(families[chunk.begin]);
    // The tables of the stream: those of the hierarchy are being written.
    std::move(loaded.cells.begin(), loaded.cells.end(),
              hierarchy.cells.begin() + family_cells(stream.tables(), loaded.parent).begin);
    cells.memory[chunk.begin] = std::move(loaded.memory);
  });
  return cells;
}

}  // namespace lodestone
