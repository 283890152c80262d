// The cells of a .lode file dealt out to the ranks of a job, for work on one cell after the other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "parallel/distributed/messages/ranks.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct RankCells {
  // The tables of all cells; payloads of the rank's own cells and of their parents, the arrays of all others as long as
  // they are, but not to be read.
  Hierarchy hierarchy;
  std::vector<CellId> own;             // ascending
  std::vector<std::int32_t> owner_of;  // by cell: the rank that has it
  std::vector<std::unique_ptr<std::byte[]>> memory;
};

// Each rank gets families (core/hierarchy/lode/lode_payload.h) that follow each other, of about as many bytes as every
// other rank's. No messages: all ranks read the tables, and each the payloads that it needs. Throws as load_lode does.
[[nodiscard]] RankCells load_rank_cells(const std::filesystem::path& file, int rank, int ranks, Scheduler& scheduler);

}  // namespace lodestone
