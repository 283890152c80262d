// Mesh files of any format: the reader by name or content, the writer by name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/files/byte_reader.h"
#include "core/formats/common/mesh_output.h"
#include "core/formats/common/read_config.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

enum class MeshFormat : std::uint8_t { ply, obj, stl, off, draco, gltf, tileset, hgt, ascii_grid, raw_grid };

// True if the extension is that of a mesh format, in any case.
[[nodiscard]] bool has_mesh_extension(const std::filesystem::path& path);

// By the extension (.ply, .obj, .stl, .off, .drc, .glb, .gltf, .json for tilesets, .hgt, .asc, in any case); for any
// other, config.raw_grid decides, or else the first bytes. Throws UnsupportedError listing the known formats, or
// saying that the file is a hierarchy.
[[nodiscard]] MeshFormat mesh_format(const std::filesystem::path& path, ByteReader& input,
                                     const ReadConfig& config = {});

// The up axis of a mesh of this format: asked for, as the format has it, or guessed. That of a tileset depends on where
// it lies (core/formats/tiles/tileset.h), too.
[[nodiscard]] Up up_of(MeshFormat format, const ReadConfig& config);

// Reads a whole mesh; every index it returns is in range. A folder is a tileset when it holds a tileset.json, or else
// the SRTM tiles (.hgt) in it. Throws what the readers throw (core/formats/common/read_config.h), also InputError for
// an empty file or one without a triangle, UnsupportedError for a folder without either, ResourceError when memory does
// not suffice. The parallel, faster reader of the same files is load_mesh (parallel/mesh/load.h).
[[nodiscard]] RawMesh read_mesh(const std::filesystem::path& path, const ReadConfig& config = {});

// The same from bytes; `name` stands for the file in messages.
[[nodiscard]] RawMesh read_mesh(ByteReader& input, MeshFormat format, const ReadConfig& config = {});

// A reader of a mesh file, and where it may look for the files that this one names.
[[nodiscard]] ByteReader open_mesh_file(const std::filesystem::path& path, const ReadConfig& config);

// The file to read for a path: the tileset.json of a folder that has one, else the path itself.
[[nodiscard]] std::filesystem::path mesh_path(const std::filesystem::path& path);

// Throws InputError, naming the file, when the mesh has no triangle.
void require_triangles(const RawMesh& mesh, const std::string& name);
// For a std::bad_alloc while reading.
[[noreturn]] void throw_out_of_memory(const std::string& name);

// Writes a mesh completely or not at all (core/files/atomic_file.h), by the extension: .ply, .obj, .stl or .glb, in any
// case. .glb carries all attributes; core/formats/ply/ply.h and core/formats/obj/obj.h say what .ply and .obj carry,
// and which files (images, a material library) they write beside them. PLY positions are float unless that would lose
// more than 2^-22 of the model's extent (a model far from the origin), then double; OBJ positions are the shortest
// decimals that read back as the same double; STL knows float only. Returns what the format loses beyond that, a line
// each that names the file. Throws UnsupportedError for other extensions, InputError where float would destroy the
// model, FileError when a file cannot be written; then no new file is left and older ones are as they were, unless the
// last step, renaming the finished files, failed between two of them.
std::vector<std::string> write_mesh(const std::filesystem::path& path, const MeshView& mesh);

}  // namespace lodestone
