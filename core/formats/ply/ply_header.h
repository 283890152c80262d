// The header of a PLY file: which elements follow, of what properties, in what encoding.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/byte_reader.h"
#include "core/files/scalar.h"
#include "core/formats/common/fixed_layout.h"

namespace lodestone {

struct PlyProperty {
  std::string name;
  ScalarType type{};                     // of the value, or of the items of a list
  std::optional<ScalarType> count_type;  // a list, and the type of its length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  [[nodiscard]] const PlyProperty* find(std::string_view property) const;
  // The list of vertex indices of a face or strip, by any of its usual names; nullptr when there is none.
  [[nodiscard]] const PlyProperty* index_list() const;
  // Two texture coordinates per corner of a face, and the number of the face's texture; nullptr when there is none.
  [[nodiscard]] const PlyProperty* texture_coordinate_list() const;
  [[nodiscard]] const PlyProperty* texture_number() const;
  // The least number of bytes one of them takes; the exact number for a binary element without lists.
  [[nodiscard]] std::uint64_t least_bytes(bool ascii) const;
};

struct PlyHeader {
  std::optional<std::endian> byte_order;  // empty: ASCII
  std::vector<PlyElement> elements;       // in file order
  std::uint64_t data_offset = 0;          // first byte after the header
  std::uint64_t lines = 0;                // of the header
  std::vector<std::string> textures;      // named by "comment TextureFile NAME", as MeshLab does

  [[nodiscard]] const PlyElement* find(std::string_view element) const;
  [[nodiscard]] std::uint64_t vertex_count() const;
  // Whether faces have texture coordinates at their corners, or numbers of textures that the header names.
  [[nodiscard]] bool has_textured_faces() const;
};

// The properties of a vertex that make an attribute, in order: all of them or none.
struct PlyVertexAttributes {
  std::vector<const PlyProperty*> normal, colour, uv;  // 3, 3 or 4, and 2 of them
};
[[nodiscard]] PlyVertexAttributes vertex_attributes(const PlyElement& vertex);

// Reads up to the line after end_header. Every declared count is checked against the bytes that are left, so that what
// is allocated for them is bounded by the size of the file. Throws InputError naming file and line, UnsupportedError
// for other versions, ResourceError for more vertices than 32-bit indices reach.
[[nodiscard]] PlyHeader read_ply_header(ByteReader& input);

// Where the vertices and triangles of the common binary layout lie: vertices of fixed size, and faces that, when all of
// them are triangles, are of fixed size too.
struct PlyFixedLayout {
  VertexLayout vertices;
  VertexAttributeLayout attributes;
  TriangleLayout triangles;
  std::uint64_t vertex_offset = 0, vertex_count = 0;
  std::uint64_t triangle_offset = 0, triangle_count = 0;
  std::uint64_t end = 0;  // of the last element
};

[[nodiscard]] std::optional<VertexLayout> vertex_layout(const PlyHeader& header, const PlyElement& vertex);
// For a vertex element that has a vertex_layout.
[[nodiscard]] VertexAttributeLayout vertex_attribute_layout(const PlyHeader& header, const PlyElement& vertex);
[[nodiscard]] std::optional<TriangleLayout> triangle_layout(const PlyHeader& header, const PlyElement& face);
// Empty when the file is of another layout: ASCII, other elements with lists, strips, ...
[[nodiscard]] std::optional<PlyFixedLayout> fixed_layout(const PlyHeader& header);

// What every reader of the file says about it, for the mesh's warnings: colours of faces that are left out (when
// attributes are asked for), and bytes behind the last element.
void add_ply_warnings(const PlyHeader& header, const std::string& name, bool attributes, std::uint64_t bytes_behind,
                      std::vector<std::string>& warnings);

}  // namespace lodestone
