// Kernels that decode a run of fixed-size records of a binary PLY file: pure functions of bytes, which a parallel
// reader calls on any range of records.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/files/scalar.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// A vertex record of `stride` bytes, which contains three coordinates.
struct VertexLayout {
  struct Coordinate {
    std::size_t offset = 0;
    ScalarType type{};
  };
  std::size_t stride = 0;
  std::array<Coordinate, 3> coordinates;
  std::endian byte_order = std::endian::little;
};

// Offsets of the attributes in a vertex record; an attribute that the file does not have has no values.
struct VertexAttributeLayout {
  using Value = VertexLayout::Coordinate;
  std::size_t stride = 0;
  std::vector<Value> normal, colour, uv;  // 3, 3 or 4, and 2 of them
  std::endian byte_order = std::endian::little;
  [[nodiscard]] bool empty() const { return normal.empty() && colour.empty() && uv.empty(); }
};

// A face record that is `stride` bytes long when it is a triangle: a one-byte corner count that has to be 3, directly
// followed by three 32-bit indices, with other scalars before and after them.
struct TriangleLayout {
  std::size_t stride = 0;
  std::size_t count_offset = 0;
  std::endian byte_order = std::endian::little;
};

// Decodes out.size() records; `bytes` holds at least that many.
void decode_vertices(const VertexLayout& layout, std::span<const char> bytes, std::span<Vec3d> out);

// Resizes the arrays of `wedges` that the layout fills.
void resize_attributes(const VertexAttributeLayout& layout, std::size_t vertices, RawWedges& wedges);
// Decodes `count` records into those arrays from `first` on.
void decode_attributes(const VertexAttributeLayout& layout, std::span<const char> bytes, std::size_t first,
                       std::size_t count, RawWedges& wedges);

// A component of a colour by the convention of its type: the maximum is 65535 for 16-bit integers, 255 for all other
// integers, 1 for floating-point numbers.
[[nodiscard]] std::uint8_t colour_component(ScalarType type, double value);

// The same for triangles. Returns the number of triangles before the first record that is not a triangle or has an
// index of vertex_count or more: there the caller has to use the general reader.
[[nodiscard]] std::size_t decode_triangles(const TriangleLayout& layout, std::span<const char> bytes,
                                           std::uint32_t vertex_count, std::span<Triangle> out);

}  // namespace lodestone
