// Writing and opening .lode files with all workers: the same bytes and the same checks as core/hierarchy/lode_file.h.
#pragma once

#include <filesystem>

#include "core/hierarchy/hierarchy.h"
#include "parallel/scheduler.h"

namespace lodestone {

// As write_lode; payloads are encoded, summed and written at their offsets in parallel. Working memory: one chunk of
// about 4 MiB (at least one cell) per worker.
void save_lode(const Hierarchy& hierarchy, const std::filesystem::path& path, Scheduler& scheduler);

// As open_lode; the payloads are checked in parallel.
[[nodiscard]] Hierarchy load_lode(const std::filesystem::path& path, Scheduler& scheduler);

}  // namespace lodestone
