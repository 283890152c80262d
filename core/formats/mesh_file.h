// Mesh files of any format: the reader by name or content (core/formats/mesh_reader.h), the writer by name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

struct MeshView;  // core/formats/common/mesh_view.h

// True if the extension is that of a mesh format, in any case.
[[nodiscard]] bool has_mesh_extension(const std::filesystem::path& path);

// Reads a whole mesh; every index it returns is in range. A folder is a tileset when it holds a tileset.json, or else
// the SRTM tiles (.hgt) in it. Throws what the readers throw (core/formats/common/read_config.h), also InputError for
// an empty file or one without a triangle, UnsupportedError for a folder without either, ResourceError when memory does
// not suffice. The parallel, faster reader of the same files is load_mesh (parallel/mesh/load.h).
[[nodiscard]] RawMesh read_mesh(const std::filesystem::path& path, const ReadConfig& config = {});

// Writes a mesh completely or not at all (core/files/atomic_file.h), by the extension: .ply, .obj, .stl or .glb, in any
// case. .glb carries all attributes; core/formats/ply/ply.h and core/formats/obj/obj.h say what .ply and .obj carry,
// and which files (images, a material library) they write beside them. PLY positions are float unless that would lose
// more than 2^-22 of the model's extent (a model far from the origin), then double; OBJ positions are the shortest
// decimals that read back as the same double; STL knows float only. Returns what the format loses beyond that, a line
// each that names the file. Throws UnsupportedError for other extensions, InputError where float would destroy the
// model, FileError when a file cannot be written; then no new file is left and older ones are as they were, unless the
// last step, renaming the finished files, failed between two of them. Wedges that are not the vertices are left out; an
// IndexedMesh is written in the space of the file that it was read from.
std::vector<std::string> write_mesh(const std::filesystem::path& path, const RawMesh& mesh);
std::vector<std::string> write_mesh(const std::filesystem::path& path, const IndexedMesh& mesh);
std::vector<std::string> write_mesh(const std::filesystem::path& path, const MeshView& mesh);

}  // namespace lodestone
