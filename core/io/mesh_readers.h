// The readers of mesh files, one per format; mesh_file.h chooses among them.
//
// Each reads from the current offset to the end of the mesh and checks what it is told: no memory is allocated for a
// declared count that the remaining bytes cannot hold, and every index is checked against the number of vertices.
// Coordinates that are not finite are read as they are. Polygons become fans (core/io/polygon_fan.h); faces of fewer
// than three corners are dropped and counted. Normals, colours, texture coordinates and groups are skipped.
//
// All throw InputError for a malformed or truncated file, with the line or the element and byte offset; FileError when
// the disk fails; UnsupportedError for variants of a format that are not read; ResourceError for more vertices than
// 32-bit indices reach.
#pragma once

#include <string_view>

#include "core/io/byte_reader.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// PLY 1.0, ASCII or binary of either byte order, scalars of any type. Elements: vertex, face, tristrips; others
// skipped.
[[nodiscard]] RawMesh read_ply(ByteReader& input);
// Wavefront OBJ: v and f; indices counted from 1, or backwards from the latest vertex when negative.
[[nodiscard]] RawMesh read_obj(ByteReader& input);
// STL, binary or ASCII, told apart by size: many binary files begin with "solid". Three vertices per triangle,
// unwelded.
[[nodiscard]] RawMesh read_stl(ByteReader& input);
// OFF, also with normals, colours or texture coordinates per vertex (NOFF, COFF, STOFF and combinations). Not read:
// binary OFF, and 4OFF and nOFF of other dimensions.
[[nodiscard]] RawMesh read_off(ByteReader& input);
// Draco compressed meshes.
[[nodiscard]] RawMesh read_draco(ByteReader& input);

// True for the first bytes of a binary STL file of this size.
[[nodiscard]] bool is_binary_stl(std::string_view head, std::uint64_t size);

}  // namespace lodestone
