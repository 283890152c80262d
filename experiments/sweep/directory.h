// The directory of a sweep: made or checked, with its inputs and sweep.json, before anything runs.
#pragma once

#include <filesystem>

#include "experiments/sweep/plan.h"

namespace lodestone {

// Throws InputError when the directory holds something else than this sweep, a sweep.json that cannot be read, or
// results while `resume` is off.
void check_directory(const std::filesystem::path& directory, const std::string& sweep, bool resume);

// Inputs found or made, runs listed in sweep.json. One process at a time does so, others wait.
[[nodiscard]] SweepPlan prepare_directory(const SweepFile& file, const InputConfig& config);

}  // namespace lodestone
