// Writing and opening .lode files with all workers: the same bytes and the same checks as core/hierarchy/lode/lode_file.h.
#pragma once

#include <filesystem>

#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/model/hierarchy.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// As write_lode; payloads are encoded, summed and written at their offsets in parallel. Working memory: one chunk of
// about 4 MiB (at least one cell) per worker; all of the file for a compressed one, whose offsets are known last.
std::uint64_t save_lode(const Hierarchy& hierarchy, const std::filesystem::path& path, Scheduler& scheduler,
                        LodeForm form = LodeForm::plain);

// As open_lode; the payloads are decompressed and checked in parallel.
[[nodiscard]] Hierarchy load_lode(const std::filesystem::path& path, Scheduler& scheduler);

}  // namespace lodestone
