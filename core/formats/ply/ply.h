// PLY (Turk 1994): reader and writer of whole meshes.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/files/byte_reader.h"
#include "core/files/scalar.h"
#include "core/formats/common/mesh_companions.h"
#include "core/formats/common/mesh_view.h"
#include "core/formats/common/read_config.h"

namespace lodestone {

// PLY 1.0, ASCII or binary of either byte order, scalars of any type. Elements: vertex, face, tristrips; others are
// skipped. Attributes: nx ny nz; red green blue, alpha; s t, u v or texture_u texture_v of vertices; texcoord and
// texnumber of faces with "comment TextureFile". Colours of faces, and bytes after the last element, are warnings.
[[nodiscard]] RawMesh read_ply(ByteReader& input, const ReadConfig& config = {});

// Writes binary PLY. A vertex has x, y, z and, where the mesh has them, nx, ny, nz, red, green, blue (and alpha if one
// is not opaque), s and t from the lower left corner. Images of base colours are companions, named by "comment
// TextureFile"; if they differ between faces, "texnumber" tells which (-1: none). PLY has no place for other
// properties of materials.
void write_ply(AtomicFile& file, const MeshView& mesh, MeshCompanions& companions);

// The parts of a binary little-endian PLY file, for callers that write it piece by piece: the header, then vertex
// records of three scalars (float32 or float64), then records of ply_triangle_bytes.
[[nodiscard]] std::string ply_header(std::size_t vertices, std::size_t triangles, ScalarType coordinates);
inline constexpr std::size_t ply_triangle_bytes = 13;
// `out` has ply_triangle_bytes per triangle.
void encode_ply_triangles(std::span<const Triangle> triangles, std::span<std::byte> out);

}  // namespace lodestone
