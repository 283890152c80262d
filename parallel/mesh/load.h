// Loading mesh files in parallel.
#pragma once

#include <filesystem>
#include <span>

#include "core/formats/common/read_config.h"
#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// The same mesh as read_mesh (core/formats/mesh_file.h), the same bytes and the same errors, but the pieces of a
// MeshStream and the tiles of a tileset are read side by side. Memory: the mesh and one mebibyte per worker; for a
// tileset, the mesh and 64 tiles.
[[nodiscard]] RawMesh load_mesh(const std::filesystem::path& path, Scheduler& scheduler, const ReadConfig& config = {});

// Several files, at least one, as one mesh in their order (core/mesh/raw_mesh.h). Throws InputError, naming a file, if
// its up axis is not that of the first.
[[nodiscard]] RawMesh load_meshes(std::span<const std::filesystem::path> files, Scheduler& scheduler,
                                  const ReadConfig& config = {});

}  // namespace lodestone
