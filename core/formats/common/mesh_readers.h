// The readers of mesh files, one per format; mesh_file.h chooses among them.
//
// Each reads from the current offset to the end of the mesh and checks what it is told: no memory is allocated for a
// declared count that the remaining bytes cannot hold, and every index is checked against the number of vertices.
// Coordinates that are not finite are read as they are. Polygons become fans (core/formats/common/polygon_fan.h); faces of fewer
// than three corners are dropped and counted. What ReadConfig does not ask for is skipped. Attributes and materials are
// read where this header says so; what is wrong with them alone, down to a missing image, is a warning in the mesh.
//
// All throw InputError for a malformed or truncated file, with the line or the element and byte offset; FileError when
// the disk fails; UnsupportedError for variants of a format that are not read; ResourceError for more vertices than
// 32-bit indices reach.
#pragma once

#include <string_view>

#include "core/files/byte_reader.h"
#include "core/formats/common/read_config.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// PLY 1.0, ASCII or binary of either byte order, scalars of any type. Elements: vertex, face, tristrips; others
// skipped. Attributes: nx ny nz; red green blue, alpha; s t, u v or texture_u texture_v of vertices; texcoord and
// texnumber of faces with "comment TextureFile". Colours of faces, and bytes behind the last element, are warnings.
[[nodiscard]] RawMesh read_ply(ByteReader& input, const ReadConfig& config = {});
// Wavefront OBJ: v and f; indices counted from 1, or backwards from the latest value when negative. Attributes: vt, vn,
// colours behind positions, usemtl with the libraries of mtllib.
[[nodiscard]] RawMesh read_obj(ByteReader& input, const ReadConfig& config = {});
// STL, binary or ASCII, told apart by size: many binary files begin with "solid". Three vertices per triangle,
// unwelded.
[[nodiscard]] RawMesh read_stl(ByteReader& input);
// OFF. Attributes: normals, colours and texture coordinates per vertex (NOFF, COFF, STOFF and combinations). Not read:
// colours of faces (a warning); binary OFF, and 4OFF and nOFF of other dimensions.
[[nodiscard]] RawMesh read_off(ByteReader& input, const ReadConfig& config = {});
// Draco compressed meshes. Attributes: the first normals, colours and texture coordinates.
[[nodiscard]] RawMesh read_draco(ByteReader& input, const ReadConfig& config = {});
// glTF 2.0, text or binary (told apart by the first bytes): the triangles of the default scene, moved by their nodes.
// Attributes: NORMAL, COLOR_0, TEXCOORD_n, materials with base colour and normal map. Buffers may be compressed by
// KHR_draco_mesh_compression and EXT_meshopt_compression, values by KHR_mesh_quantization. Not read: points and lines,
// skins and morph targets (the pose at rest is), both with a warning; other extensions that a file requires.
[[nodiscard]] RawMesh read_gltf(ByteReader& input, const ReadConfig& config = {});
// 3D Tiles 1.0 and 1.1: the finest tiles, in the coordinates of the root, on the Earth mostly (core/formats/tiles/tileset.h).
[[nodiscard]] RawMesh read_tileset(ByteReader& input, const ReadConfig& config = {});
// Height grids (core/formats/terrain/grid_readers.h): an SRTM tile, whose name tells its place; an ESRI ASCII grid; bare numbers.
[[nodiscard]] RawMesh read_hgt(ByteReader& input, const ReadConfig& config = {});
[[nodiscard]] RawMesh read_ascii_grid(ByteReader& input, const ReadConfig& config = {});
[[nodiscard]] RawMesh read_raw_grid(ByteReader& input, const ReadConfig& config);

// True for the first bytes of a binary STL file of this size.
[[nodiscard]] bool is_binary_stl(std::string_view head, std::uint64_t size);

}  // namespace lodestone
