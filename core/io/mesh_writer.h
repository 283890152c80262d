// Writing mesh files: binary PLY, OBJ, binary STL, binary glTF. Complete or not at all (core/io/atomic_file.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "core/io/atomic_file.h"
#include "core/io/scalar.h"
#include "core/mesh/clean.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// What is written, wherever it lies: positions in the space of the file, and triangles into them.
struct MeshView {
  std::size_t vertex_count = 0;
  std::function<Vec3d(std::size_t)> position;
  std::span<const Triangle> triangles;
  // Attributes by vertex, for formats that have them; null: none.
  const RawWedges* wedges = nullptr;
  std::span<const Material> materials{};
  std::span<const Texture> textures{};
};

// The mesh has to outlive its view. Wedges that are not the vertices are left out.
[[nodiscard]] MeshView view_of(const RawMesh& mesh);
[[nodiscard]] MeshView view_of(const IndexedMesh& mesh);  // in the space of the file that it was read from

// Of all its vertices; inside out when there are none.
[[nodiscard]] Box3d box_of(const MeshView& mesh);

// By the extension: .ply, .obj, .stl or .glb, in any case. .glb carries all attributes; what .ply and .obj carry, and
// which files they write beside (images, a material library), say core/io/ply_writer.h and obj_writer.h. PLY positions
// are float unless that would lose more than 2^-22 of the model's extent (a model far from the origin), then double;
// OBJ positions are the shortest decimals that read back as the same double; STL knows float only. Throws
// UnsupportedError for other extensions, FileError when a file cannot be written; then none is left and older ones are
// as they were, unless the last step, renaming the finished files, failed between two of them.
void write_mesh(const std::filesystem::path& path, const MeshView& mesh);

// The parts of a binary little-endian PLY file, for those that write it piece by piece: the header, then vertex records
// of three scalars (float32 or float64), then records of triangle_record_bytes.
[[nodiscard]] std::string ply_header(std::size_t vertices, std::size_t triangles, ScalarType coordinates);
inline constexpr std::size_t ply_triangle_bytes = 13;
// `out` is of ply_triangle_bytes per triangle.
void encode_ply_triangles(std::span<const Triangle> triangles, std::span<std::byte> out);

}  // namespace lodestone
