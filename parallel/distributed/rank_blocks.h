// The levels above the finest one: each rank runs its blocks, level by level, and sends the cells that they make to the
// ranks that run theirs.
#pragma once

#include <functional>
#include <vector>

#include "parallel/distributed/cell_owners.h"
#include "parallel/distributed/messages/ranks.h"
#include "parallel/distributed/rank_finest.h"
#include "parallel/hierarchy/build.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

inline constexpr std::size_t exchange_round_bytes = std::size_t{8} << 20;  // of cells that a rank sends in a round

struct BlockSetting {
  const BuildConfig& config;  // its strategy and progress are not used
  const CellOwners& owners;
  Lattice lattice{};
  AttributeSet attributes{};
};

// Returns the rank's cells by level, from the root: complete, each at the rank that has run its block. A rank may have
// none of a level. `triangles`, of the finest level, remain in use. Memory: the cells, those under way, and block
// memory for each worker; nothing that grows with the cells of other ranks.
[[nodiscard]] std::vector<CellPart> build_rank_levels(CellPart&& finest, int level, const BlockSetting& setting,
                                                      Ranks& ranks, Scheduler& scheduler);

}  // namespace lodestone
