// Writing mesh files: binary PLY, OBJ, binary STL, binary glTF. Complete or not at all (core/files/atomic_file.h).
#pragma once

#include <filesystem>

#include "core/formats/common/mesh_view.h"

namespace lodestone {

// By the extension: .ply, .obj, .stl or .glb, in any case. .glb carries all attributes; what .ply and .obj carry, and
// which files they write beside (images, a material library), say core/formats/ply/ply_writer.h and obj_writer.h. PLY positions
// are float unless that would lose more than 2^-22 of the model's extent (a model far from the origin), then double;
// OBJ positions are the shortest decimals that read back as the same double; STL knows float only. Throws
// UnsupportedError for other extensions, FileError when a file cannot be written; then none is left and older ones are
// as they were, unless the last step, renaming the finished files, failed between two of them.
void write_mesh(const std::filesystem::path& path, const MeshView& mesh);

}  // namespace lodestone
