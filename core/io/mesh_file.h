// Mesh files: the reader by name or content.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/io/byte_reader.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

enum class MeshFormat : std::uint8_t { ply, obj, stl, off, draco };

// Whether the extension is that of a mesh format, in any case.
[[nodiscard]] bool has_mesh_extension(const std::filesystem::path& path);

// By the extension (.ply, .obj, .stl, .off, .drc, in any case) or, when that is another or none, by the first bytes.
// Throws UnsupportedError listing the known formats, or saying that the file is a hierarchy.
[[nodiscard]] MeshFormat mesh_format(const std::filesystem::path& path, ByteReader& input);

// Reads a whole mesh; every index it returns is in range. Throws what the readers throw (core/io/mesh_readers.h), also
// InputError for an empty file or one without a triangle, ResourceError when memory does not suffice.
// The parallel, faster reader of the same files is load_mesh (parallel/load.h).
[[nodiscard]] RawMesh read_mesh(const std::filesystem::path& path);

// The same from bytes; `name` stands for the file in messages.
[[nodiscard]] RawMesh read_mesh(ByteReader& input, MeshFormat format);

// Throws InputError, naming the file, when the mesh has no triangle.
void require_triangles(const RawMesh& mesh, const std::string& name);
// For a std::bad_alloc while reading.
[[noreturn]] void throw_out_of_memory(const std::string& name);

}  // namespace lodestone
