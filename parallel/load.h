// Loading mesh files in parallel.
#pragma once

#include <filesystem>

#include "core/mesh/indexed_mesh.h"
#include "parallel/scheduler.h"

namespace lodestone {

// The same mesh as read_mesh (core/io/mesh_file.h), the same bytes and the same errors, but binary PLY of the common
// layout (vertices of fixed size, all faces triangles with 32-bit indices) and binary STL are read and decoded in
// chunks on all workers. Memory: the mesh and one mebibyte per worker.
[[nodiscard]] RawMesh load_mesh(const std::filesystem::path& path, Scheduler& scheduler);

}  // namespace lodestone
