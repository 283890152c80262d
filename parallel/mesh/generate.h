// Generating surfaces in parallel: as a mesh in memory, or streamed into a file.
#pragma once

#include <filesystem>
#include <functional>

#include "core/mesh/generate.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct GenerateResult {
  std::uint64_t vertices = 0, triangles = 0, bytes = 0;
};

// The same as generate_mesh of the configuration alone, in one loop over all vertices and triangles. Throws InputError
// for a bad config, and what the scheduler throws.
[[nodiscard]] RawMesh generate_mesh(const GenerateConfig& config, Scheduler& scheduler);

// Writes binary little-endian PLY (float positions, `list uchar int` faces) aside and renames it. Memory: about a
// mebibyte per worker, whatever the size. Throws InputError for a bad config, FileError when the file cannot be
// written, Cancelled when `cancel` is set. `progress` gets the share done, one call at a time.
GenerateResult generate_ply(const GenerateConfig& config, const std::filesystem::path& target, Scheduler& scheduler,
                            const CancelFlag* cancel = nullptr, const std::function<void(double)>& progress = {});

}  // namespace lodestone
