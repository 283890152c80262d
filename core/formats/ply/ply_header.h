// The header of a PLY file: its elements, their properties, and the encoding.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/byte_reader.h"
#include "core/files/scalar.h"
#include "core/formats/ply/ply_layout.h"

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
  // The list of two texture coordinates per corner of a face, and the number of its texture; nullptr when absent.
  [[nodiscard]] const PlyProperty* texture_coordinate_list() const;
  [[nodiscard]] const PlyProperty* texture_number() const;
  // Minimum size of one record in bytes; its exact size for a binary element without lists.
  [[nodiscard]] std::uint64_t min_bytes(bool ascii) const;
};

struct PlyHeader {
  std::optional<std::endian> byte_order;  // empty: ASCII
  std::vector<PlyElement> elements;       // in file order
  std::uint64_t data_offset = 0;          // first byte after the header
  std::uint64_t lines = 0;                // of the header
  std::vector<std::string> textures;      // named by "comment TextureFile NAME", as MeshLab does

  [[nodiscard]] const PlyElement* find(std::string_view element) const;
  [[nodiscard]] std::uint64_t vertex_count() const;
  // True if faces have texture coordinates at their corners, or numbers of textures that the header names.
  [[nodiscard]] bool has_textured_faces() const;
};

// The properties of a vertex that make an attribute, in order: all of them or none.
struct PlyVertexAttributes {
  std::vector<const PlyProperty*> normal, colour, uv;  // 3, 3 or 4, and 2 of them
};
[[nodiscard]] PlyVertexAttributes vertex_attributes(const PlyElement& vertex);

// Reads up to the line after end_header. Every declared count is checked against the remaining bytes, so that the
// memory allocated for it is bounded by the size of the file. Throws InputError naming file and line, UnsupportedError
// for other versions, ResourceError for more vertices than 32-bit indices reach.
[[nodiscard]] PlyHeader read_ply_header(ByteReader& input);

// Offsets in the common binary layout, in which vertices have a fixed size, and faces, too, if all are triangles.
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

// Adds the warnings of every reader of the file: colours of faces that are left out (when attributes are asked for),
// and bytes after the last element.
void add_ply_warnings(const PlyHeader& header, const std::string& name, bool attributes, std::uint64_t bytes_after,
                      std::vector<std::string>& warnings);

}  // namespace lodestone
