// The steps of reading a mesh file of any format: finding it, telling its format, and the reader of that format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/files/byte_reader.h"
#include "core/formats/common/read_config.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

enum class MeshFormat : std::uint8_t { ply, obj, stl, off, draco, gltf, tileset, hgt, ascii_grid, raw_grid };

[[nodiscard]] std::optional<MeshFormat> format_of_extension(const std::filesystem::path& path);  // in any case

// By the extension (.ply, .obj, .stl, .off, .drc, .glb, .gltf, .json for tilesets, .hgt, .asc, in any case); for any
// other, config.raw_grid decides, or else the first bytes. Throws UnsupportedError listing the known formats, naming
// that of another program, or saying that the file is a hierarchy.
[[nodiscard]] MeshFormat mesh_format(const std::filesystem::path& path, ByteReader& input,
                                     const ReadConfig& config = {});

// The up axis of a mesh of this format: asked for, as the format has it, or guessed. That of a tileset depends on where
// it lies (core/formats/tiles/tileset.h), too.
[[nodiscard]] Up up_of(MeshFormat format, const ReadConfig& config);

// As read_mesh of a path (core/formats/mesh_file.h), from bytes.
[[nodiscard]] RawMesh read_mesh(ByteReader& input, MeshFormat format, const ReadConfig& config = {});

// A reader of a mesh file, and where it may look for the files that this one names.
[[nodiscard]] ByteReader open_mesh_file(const std::filesystem::path& path, const ReadConfig& config);

// The file to read for a path: the tileset.json of a folder that has one, else the path itself.
[[nodiscard]] std::filesystem::path mesh_path(const std::filesystem::path& path);

// Throws InputError, naming the file, when the mesh has no triangle.
void require_triangles(const RawMesh& mesh, const std::string& name);
// For a std::bad_alloc while reading.
[[noreturn]] void throw_out_of_memory(const std::string& name);

}  // namespace lodestone
