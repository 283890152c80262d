// Binary PLY (Turk 1994).
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/files/atomic_file.h"
#include "core/files/scalar.h"
#include "core/formats/common/mesh_companions.h"
#include "core/formats/common/mesh_view.h"

namespace lodestone {

// Per vertex x, y, z and, where the mesh has them, nx, ny, nz, red, green, blue (and alpha where one is not opaque), s
// and t from the lower left corner. Images of base colours are companions, named by "comment TextureFile", and the
// faces say which by "texnumber" (-1: none) where it is not the same for all; other properties of materials are not
// written, PLY has no place for them.
void write_ply(AtomicFile& file, const MeshView& mesh, MeshCompanions& companions);

// The parts of a binary little-endian PLY file, for those that write it piece by piece: the header, then vertex records
// of three scalars (float32 or float64), then records of triangle_record_bytes.
[[nodiscard]] std::string ply_header(std::size_t vertices, std::size_t triangles, ScalarType coordinates);
inline constexpr std::size_t ply_triangle_bytes = 13;
// `out` is of ply_triangle_bytes per triangle.
void encode_ply_triangles(std::span<const Triangle> triangles, std::span<std::byte> out);

}  // namespace lodestone
