// Kernels that decode a run of fixed-size records of a binary mesh file: pure functions of bytes, which a parallel
// reader calls on any range of records.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/files/scalar.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// A vertex record of `stride` bytes with three scalars somewhere in it.
struct VertexLayout {
  struct Coordinate {
    std::size_t offset = 0;
    ScalarType type{};
  };
  std::size_t stride = 0;
  std::array<Coordinate, 3> coordinates;
  std::endian byte_order = std::endian::little;
};

// Where the attributes of a vertex record lie; an attribute that the file has not has no values.
struct VertexAttributeLayout {
  using Value = VertexLayout::Coordinate;
  std::size_t stride = 0;
  std::vector<Value> normal, colour, uv;  // 3, 3 or 4, and 2 of them
  std::endian byte_order = std::endian::little;
  [[nodiscard]] bool empty() const { return normal.empty() && colour.empty() && uv.empty(); }
};

// A face record that is `stride` bytes long when it is a triangle: a one-byte corner count that has to be 3, directly
// followed by three 32-bit indices, with other scalars before and behind.
struct TriangleLayout {
  std::size_t stride = 0;
  std::size_t count_offset = 0;
  std::endian byte_order = std::endian::little;
};

// Decodes out.size() records; `bytes` holds at least that many.
void decode_vertices(const VertexLayout& layout, std::span<const char> bytes, std::span<Vec3d> out);

// The arrays of `wedges` that the layout fills, for this many vertices.
void resize_attributes(const VertexAttributeLayout& layout, std::size_t vertices, RawWedges& wedges);
// Decodes `count` records into those arrays from `first` on.
void decode_attributes(const VertexAttributeLayout& layout, std::span<const char> bytes, std::size_t first,
                       std::size_t count, RawWedges& wedges);

// A component of a colour by the convention of its type: integers of 8 bits count to 255, of 16 bits to 65535, others
// are taken to be of 8 bits, too; floating-point ones go to 1.
[[nodiscard]] std::uint8_t colour_component(ScalarType type, double value);

// The same for triangles. Returns how many it decoded before the first record that is no triangle, or that has an index
// of vertex_count or more: the caller turns to the general reader there.
[[nodiscard]] std::size_t decode_triangles(const TriangleLayout& layout, std::span<const char> bytes,
                                           std::uint32_t vertex_count, std::span<Triangle> out);

// Binary STL: 84 bytes of header, then records of a normal, three corners and two more bytes.
inline constexpr std::size_t stl_header_bytes = 84;
inline constexpr std::size_t stl_facet_bytes = 50;

// The number of facets in the first 84 bytes.
[[nodiscard]] inline std::uint64_t declared_stl_facets(std::string_view head) {
  return load<std::uint32_t>(head.data() + 80);
}
// Decodes out.size() / 3 facets into their corners.
void decode_stl_corners(std::span<const char> bytes, std::span<Vec3d> out);
// Triangles of unshared corners: (first, first + 1, first + 2), and so on.
void number_corners(std::span<Triangle> out, std::uint64_t first);

}  // namespace lodestone
