// Generated models straight into a file, in parallel and without holding them in memory.
#pragma once

#include <filesystem>

#include "core/mesh/generate.h"
#include "parallel/scheduler.h"

namespace lodestone {

// Writes the surface as binary little-endian PLY with float positions: the same bytes for any number of workers.
// Memory: about two mebibytes per worker, whatever the size of the model. Throws InputError for a config out of range,
// FileError when the target cannot be written; then no file is left.
void generate_ply(const GenerateConfig& config, const std::filesystem::path& path, Scheduler& scheduler);

}  // namespace lodestone
