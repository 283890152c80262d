// Signatures of cells that lie on many ranks: the table of core/hierarchy/model/signatures.h, level by level.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/hierarchy/model/signatures.h"
#include "parallel/distributed/messages/ranks.h"

namespace lodestone {

// A cell of a level, and the number of its vertices that others share.
struct RankBorder {
  CellId cell;
  std::uint32_t shared = 0;
};
// Those vertices.
struct SharedBorder {
  std::span<const Vec3f> positions;
  std::span<const float> errors;  // by vertex; empty: all have cell_error
  float cell_error = 0;
};
// Those of the own cell with this index, until the next call.
using ReadBorder = std::function<SharedBorder(std::size_t index)>;

// At rank 0: a level, and by cell the rank that has it and its number of shared vertices.
struct LevelBorders {
  struct Owner {
    int rank;
    std::uint32_t shared;
  };
  const Level* level = nullptr;
  std::vector<Owner> owners;
};

inline constexpr std::uint64_t all_copies = std::uint64_t{1} << 60;

// Called by all ranks for each level from the root, with their cells, ascending. Rank 0 appends the level to the table;
// the others leave both as they are. Memory: 100 bytes per shared vertex of a share that is as large as the rank's own
// on average, and where more than `most_copies` of them are compared in several turns 20 bytes for each, and 100 for
// each of a turn; at rank 0 the sets of the level, a few hundred bytes per cell, and a byte per shared vertex.
void add_rank_signatures(std::span<const RankBorder> own, const ReadBorder& read, const LevelBorders& all,
                         Signatures::Table& table, Ranks& ranks, std::uint64_t most_copies = all_copies);

}  // namespace lodestone
