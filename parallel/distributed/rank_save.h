// Writes the .lode file from the cells of all ranks: the same bytes as save_lode.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "parallel/distributed/rank_finest.h"
#include "parallel/distributed/ranks.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// The tables at rank 0: of all cells with their signatures, and of all vertices that cells share.
inline constexpr std::uint64_t table_bytes_per_cell = 700, table_bytes_per_shared = 1;

// Called by all ranks, with their cells by level. Rank 0 makes the tables, which complete `head` (transform, sigma0,
// provenance) at that rank alone, and creates the file under a temporary name; every rank writes the payloads of its
// cells where they belong. Then all call last_words(), for their last messages; when none has failed, rank 0 writes the
// rest and renames the file. Returns its size at rank 0. Memory: a mebibyte for each
// worker, what add_rank_signatures takes, and at rank 0 the tables.
std::uint64_t save_ranks(const std::vector<CellPart>& levels, Hierarchy& head, const std::filesystem::path& path,
                         const std::function<void()>& last_words, Ranks& ranks, Scheduler& scheduler);

}  // namespace lodestone
