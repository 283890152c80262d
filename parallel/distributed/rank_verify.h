// Verifies a hierarchy by all ranks of a job, each its cells.
#pragma once

#include "core/hierarchy/verify/verify.h"
#include "parallel/distributed/messages/ranks.h"
#include "parallel/distributed/rank_cells.h"

namespace lodestone {

// Called by all ranks, each with its cells of one file; returns the report of verify_hierarchy on all cells, at all
// ranks. The failure that a check names is the first one of the lowest rank that has found any. Throws what
// Ranks::exchange throws. `progress` is that of the rank's own work.
[[nodiscard]] VerifyReport verify_ranks(const RankCells& cells, Ranks& ranks, const VerifyProgress& progress = {});

}  // namespace lodestone
