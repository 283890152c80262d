// STL, binary and ASCII.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/files/atomic_file.h"
#include "core/files/byte_reader.h"
#include "core/files/scalar.h"
#include "core/formats/common/mesh_view.h"

namespace lodestone {

// Binary or ASCII, told apart by size: many binary files begin with "solid". Three vertices per triangle, not welded.
[[nodiscard]] RawMesh read_stl(ByteReader& input);

// Writes binary STL, with normals; `name` stands for the file in messages. Returns a note if float32 moves vertices by
// more than 2^-22 of the model's longest extent, otherwise an empty text. Throws InputError if it moves them by more
// than 1e-4 of that, ResourceError for more triangles than the format can count.
[[nodiscard]] std::string write_stl(AtomicFile& file, const MeshView& mesh, const std::string& name);

// The parts of a binary file, for parallel readers: 84 bytes of header, then records of a normal, three corners and
// two more bytes.
inline constexpr std::size_t stl_header_bytes = 84;
inline constexpr std::size_t stl_facet_bytes = 50;

// True for the first bytes of a binary STL file of this size.
[[nodiscard]] bool is_binary_stl(std::string_view head, std::uint64_t size);
// The same, but only if the file holds all the facets that it declares, and at least one.
[[nodiscard]] bool is_complete_stl(std::string_view head, std::uint64_t size);
// The number of facets in the first 84 bytes.
[[nodiscard]] inline std::uint64_t declared_stl_facets(std::string_view head) {
  return load<std::uint32_t>(head.data() + 80);
}
// Decodes out.size() / 3 facets into their corners.
void decode_stl_corners(std::span<const char> bytes, std::span<Vec3d> out);
// Triangles of unshared corners: (first, first + 1, first + 2), and so on.
void number_corners(std::span<Triangle> out, std::uint64_t first);

}  // namespace lodestone
