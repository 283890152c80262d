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

// Those in which the rank's equal part of all bytes has the middle.
std::vector<CellId> families_of(int rank, int ranks, const CellStream& stream) {
  const std::vector<CellId> all = all_families(stream.tables());
  std::vector<std::uint64_t> end;
  for (const CellId family : all) end.push_back((end.empty() ? 0 : end.back()) + stream.family_bytes(family));
  std::vector<CellId> own;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double middle = 0.5 * (static_cast<double>(i == 0 ? 0 : end[i - 1]) + static_cast<double>(end[i]));
    const int owner = static_cast<int>(middle / static_cast<double>(end.back()) * ranks);
    if (std::min(owner, ranks - 1) == rank) own.push_back(all[i]);
  }
  return own;
}

}  // namespace

RankCells load_rank_cells(const std::filesystem::path& file, int rank, int ranks, Scheduler& scheduler) {
  const CellStream stream(file);
  RankCells cells;
  cells.hierarchy = stream.tables();
  Hierarchy& hierarchy = cells.hierarchy;
  std::vector<CellId> families = families_of(rank, ranks, stream);
  const std::size_t own = families.size();
  for (std::size_t i = 0; i < own; ++i) {
    const FamilyCells range = family_cells(hierarchy, families[i]);
    for (CellId c = range.begin; c < range.end; ++c) cells.own.push_back(c);
    if (families[i] != no_cell) families.push_back(hierarchy.cells[families[i]].parent);
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
