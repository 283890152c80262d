// General reader of PLY: ASCII and binary bodies through one template, element by element in file order.
#include <algorithm>
#include <array>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/formats/common/companion_files.h"
#include "core/formats/common/lower_left.h"
#include "core/formats/common/polygon_fan.h"
#include "core/formats/ply/ply.h"
#include "core/formats/ply/ply_header.h"
#include "core/formats/ply/ply_source.h"
#include "core/mesh/raw_mesh.h"
#include "core/mesh/wedges.h"

namespace lodestone {
namespace {

// Reads binary records of fixed size, a window at a time. Returns the number read.
template <class Source, class Layout, class Decode>
std::uint64_t read_records(Source& source, const Layout& layout, std::uint64_t count, const Decode& decode) {
  std::uint64_t done = 0;
  while (done < count) {
    const std::string_view bytes = source.input().window(layout.stride);
    const std::uint64_t whole = std::min<std::uint64_t>(bytes.size() / layout.stride, count - done);
    const std::size_t decoded =
        decode(std::span(bytes), static_cast<std::size_t>(done), static_cast<std::size_t>(whole));
    source.input().advance(decoded * layout.stride);
    done += decoded;
    if (decoded == 0 || decoded < whole) break;
  }
  return done;
}

// Index of a property among the values of a vertex.
enum Slot : std::uint8_t { slot_position = 0, slot_normal = 3, slot_colour = 6, slot_uv = 10, slot_none = 12 };

std::vector<std::uint8_t> slots_of(const PlyElement& element, const PlyVertexAttributes& attributes) {
  std::vector<std::uint8_t> slots(element.properties.size(), slot_none);
  const auto assign = [&](const std::vector<const PlyProperty*>& properties, std::size_t first) {
    for (std::size_t i = 0; i < properties.size(); ++i)
      slots[static_cast<std::size_t>(properties[i] - element.properties.data())] = static_cast<std::uint8_t>(first + i);
  };
  assign({element.find("x"), element.find("y"), element.find("z")}, slot_position);
  assign(attributes.normal, slot_normal);
  assign(attributes.colour, slot_colour);
  assign(attributes.uv, slot_uv);
  return slots;
}

template <class Source>
void require_positions(const Source& source, const PlyElement& element) {
  for (const char* axis : {"x", "y", "z"})
    if (const PlyProperty* property = element.find(axis); !property || property->count_type)
      source.fail("vertices have no x, y and z", "give a mesh in three dimensions");
}

// Reads vertices value by value: any types, text, lists among the properties.
template <class Source>
void read_vertex_values(Source& source, const PlyElement& element, const PlyVertexAttributes& attributes,
                        RawMesh& mesh) {
  const std::vector<std::uint8_t> slots = slots_of(element, attributes);
  RawWedges& wedges = mesh.wedges;
  if (!attributes.normal.empty()) wedges.normal.resize(element.count);
  if (!attributes.colour.empty()) wedges.colour.resize(element.count);
  if (!attributes.uv.empty()) wedges.uv.resize(element.count);
  std::array<double, slot_none> values{};
  for (std::uint64_t i = 0; i < element.count; ++i) {
    source.place.index = i;
    for (std::size_t p = 0; p < slots.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (slots[p] == slot_none) {
        skip_property(source, property);
      } else {
        values[slots[p]] = source.number(property);
      }
    }
    mesh.positions[i] = {values[0], values[1], values[2]};
    if (!wedges.normal.empty()) wedges.normal[i] = unit_normal({values[3], values[4], values[5]});
    if (!wedges.uv.empty()) wedges.uv[i] = from_lower_left(values[slot_uv], values[slot_uv + 1]);
    if (wedges.colour.empty()) continue;
    const auto component = [&](std::size_t k) {
      return colour_component(attributes.colour[k]->type, values[slot_colour + k]);
    };
    wedges.colour[i] = {component(0), component(1), component(2),
                        attributes.colour.size() > 3 ? component(3) : std::uint8_t{255}};
  }
}

template <class Source>
void read_vertices(Source& source, const PlyHeader& header, const PlyElement& element, const ReadConfig& config,
                   RawMesh& mesh) {
  require_positions(source, element);
  mesh.positions.resize(element.count);
  if constexpr (std::is_same_v<Source, PlyBinarySource>) {
    // The general code reads a record longer than the window (thousands of properties).
    if (const auto layout = vertex_layout(header, element); layout && layout->stride <= ByteReader::max_window) {
      const VertexAttributeLayout attributes =
          config.attributes ? vertex_attribute_layout(header, element) : VertexAttributeLayout{};
      resize_attributes(attributes, element.count, mesh.wedges);
      const std::uint64_t done =
          read_records(source, *layout, element.count, [&](auto bytes, std::size_t first, std::size_t count) {
            decode_vertices(*layout, bytes, std::span(mesh.positions).subspan(first, count));
            if (!attributes.empty()) decode_attributes(attributes, bytes, first, count, mesh.wedges);
            return count;
          });
      source.place.index = done;
      if (done < element.count) source.fail_truncated();
      return;
    }
  }
  read_vertex_values(source, element, config.attributes ? vertex_attributes(element) : PlyVertexAttributes{}, mesh);
}

template <class Source>
std::uint32_t checked_index(Source& source, std::int64_t index, std::uint64_t vertex_count) {
  if (index < 0 || static_cast<std::uint64_t>(index) >= vertex_count)
    source.fail("vertex index " + std::to_string(index) + " is out of range, the file has " +
                    std::to_string(vertex_count) + " vertices",
                ply_counts_may_be_wrong);
  return static_cast<std::uint32_t>(index);
}

template <class Source>
void read_polygon(Source& source, const PlyProperty& list, std::uint64_t vertex_count, PolygonFan& fan) {
  const std::uint64_t corners = list_length(source, list);
  for (std::uint64_t i = 0; i < corners; ++i) fan.add(checked_index(source, source.integer(list), vertex_count));
  fan.close();
}

// A strip of triangles, of which every other one is turned; -1 ends it and begins another. Triangles with two equal
// corners, which stitch strips together, are left to the cleaning of the mesh.
template <class Source>
void read_strip(Source& source, const PlyProperty& list, std::uint64_t vertex_count, RawMesh& mesh) {
  const std::uint64_t length = list_length(source, list);
  std::uint64_t corners = 0;
  std::uint32_t before = 0, latest = 0;
  for (std::uint64_t i = 0; i < length; ++i) {
    const std::int64_t index = source.integer(list);
    if (index == -1) {
      corners = 0;
      continue;
    }
    const std::uint32_t corner = checked_index(source, index, vertex_count);
    if (corners >= 2)
      mesh.triangles.push_back(corners % 2 == 0 ? Triangle{{before, latest, corner}}
                                                : Triangle{{latest, before, corner}});
    before = std::exchange(latest, corner);
    ++corners;
  }
}

template <class Source>
const PlyProperty* index_list(Source& source, const PlyElement& element) {
  const PlyProperty* indices = element.index_list();
  if (!indices) source.fail("faces have no list of vertex_indices", "give a mesh of polygons or strips");
  if (!is_integer(indices->type)) source.fail("vertex indices are not integers", "the header is damaged");
  return indices;
}

// Reads faces or strips from number `first` on: `read_list` reads the list of vertex indices, other properties are
// skipped.
template <class Source, class ReadList>
void read_lists(Source& source, const PlyElement& element, std::uint64_t first, const ReadList& read_list) {
  const PlyProperty* indices = index_list(source, element);
  for (std::uint64_t i = first; i < element.count; ++i) {
    source.place.index = i;
    for (const PlyProperty& property : element.properties)
      &property == indices ? read_list(property) : skip_property(source, property);
  }
}

template <class Source>
void read_faces(Source& source, const PlyHeader& header, const PlyElement& element, RawMesh& mesh, PolygonFan& fan) {
  const std::uint64_t vertex_count = header.vertex_count();
  (void)index_list(source, element);  // before memory is reserved for elements that may have no size
  mesh.triangles.reserve(mesh.triangles.size() + element.count);
  std::uint64_t done = 0;
  if constexpr (std::is_same_v<Source, PlyBinarySource>) {
    // The fast kernel reads up to the first face that is not a triangle; the general code reads the rest.
    if (const auto layout = triangle_layout(header, element); layout && layout->stride <= ByteReader::max_window) {
      done = read_records(source, *layout, element.count, [&](auto bytes, std::size_t, std::size_t count) {
        const std::size_t before = mesh.triangles.size();
        mesh.triangles.resize(before + count);
        const std::size_t decoded = decode_triangles(*layout, bytes, static_cast<std::uint32_t>(vertex_count),
                                                     std::span(mesh.triangles).subspan(before));
        mesh.triangles.resize(before + decoded);
        return decoded;
      });
    }
  }
  read_lists(source, element, done, [&](const PlyProperty& list) { read_polygon(source, list, vertex_count, fan); });
}

// Texture coordinates at the corners of faces, collected until vertices and faces are complete, in either order.
struct FaceCoordinates {
  std::vector<Vec2f> uv;
  std::vector<Triangle> uv_of;
  std::uint64_t faces_without = 0;
};

// Faces with texture coordinates at their corners, or with the number of a texture, as MeshLab writes them.
template <class Source>
class TexturedFaces {
 public:
  TexturedFaces(Source& source, const PlyHeader& header, const PlyElement& element, RawMesh& mesh, PolygonFan& fan,
                FaceCoordinates& coordinates)
      : source_(&source),
        element_(&element),
        vertex_count_(header.vertex_count()),
        mesh_(&mesh),
        fan_(&fan),
        coordinates_(&coordinates),
        indices_(index_list(source, element)),
        uv_(element.texture_coordinate_list()),
        texture_(header.textures.empty() ? nullptr : element.texture_number()) {}

  void read() {
    if (uv_) coordinates_->uv_of.resize(mesh_->triangles.size(), no_values);
    if (texture_) mesh_->wedges.material.resize(mesh_->triangles.size(), no_material);
    for (std::uint64_t i = 0; i < element_->count; ++i) {
      source_->place.index = i;
      read_face();
    }
  }

 private:
  void read_face() {
    corners_.clear();
    values_.clear();
    std::int64_t texture = -1;
    for (const PlyProperty& property : element_->properties) {
      if (&property == indices_) {
        const std::uint64_t count = list_length(*source_, property);
        for (std::uint64_t i = 0; i < count; ++i)
          corners_.push_back(checked_index(*source_, source_->integer(property), vertex_count_));
      } else if (&property == uv_) {
        const std::uint64_t count = list_length(*source_, property);
        for (std::uint64_t i = 0; i < count; ++i) values_.push_back(source_->number(property));
      } else if (&property == texture_) {
        texture = source_->integer(property);
      } else {
        skip_property(*source_, property);
      }
    }
    for (const std::uint32_t corner : corners_) fan_->add(corner);
    fan_->close();
    if (uv_) add_coordinates();
    const bool known = texture >= 0 && static_cast<std::uint64_t>(texture) < mesh_->materials.size();
    if (texture_)
      mesh_->wedges.material.resize(mesh_->triangles.size(), known ? static_cast<std::uint32_t>(texture) : no_material);
  }

  void add_coordinates() {
    std::vector<Vec2f>& uv = coordinates_->uv;
    if (uv.size() + corners_.size() >= no_value)
      source_->fail("more corners with texture coordinates than 32-bit indices reach", "split the model");
    const bool complete = values_.size() == 2 * corners_.size();
    coordinates_->faces_without += !complete;
    TriangleFan fan(coordinates_->uv_of);
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (complete) uv.push_back(from_lower_left(values_[2 * i], values_[2 * i + 1]));
      fan.add(complete ? static_cast<std::uint32_t>(uv.size() - 1) : no_value);
    }
  }

  Source* source_;
  const PlyElement* element_;
  std::uint64_t vertex_count_;
  RawMesh* mesh_;
  PolygonFan* fan_;
  FaceCoordinates* coordinates_;
  const PlyProperty *indices_, *uv_, *texture_;
  std::vector<std::uint32_t> corners_;  // of the latest face
  std::vector<double> values_;
};

// Makes wedges from the attributes of corners and of their vertices.
void share_corners(RawMesh& mesh, FaceCoordinates&& coordinates) {
  RawWedges& vertices = mesh.wedges;
  CornerAttributes attributes{.uv = std::move(coordinates.uv),
                              .normal = std::move(vertices.normal),
                              .uv_of = std::move(coordinates.uv_of),
                              .normal_of = {},
                              .colour = std::move(vertices.colour)};
  if (!attributes.normal.empty()) attributes.normal_of = mesh.triangles;
  std::vector<std::uint32_t> material = std::move(vertices.material);
  mesh.wedges = make_wedges(mesh.triangles, mesh.positions.size(), attributes);
  mesh.wedges.material = std::move(material);
}

// A material for each texture that the header names.
void add_materials(const PlyHeader& header, const ByteReader& input, RawMesh& mesh) {
  TextureSet textures(mesh, input);
  for (const std::string& name : header.textures) {
    Material& material = mesh.materials.emplace_back();
    material.name = name;
    set_colour_texture(material, textures.add_file(name, "header"));
  }
}

template <class Source>
void skip_element(Source& source, const PlyElement& element) {
  if (element.properties.empty()) return;  // of any count, but without bytes
  for (std::uint64_t i = 0; i < element.count; ++i) {
    source.place.index = i;
    for (const PlyProperty& property : element.properties) skip_property(source, property);
  }
}

template <class Source>
RawMesh read_body(Source source, const PlyHeader& header, const ByteReader& input, const ReadConfig& config) {
  RawMesh mesh;
  PolygonFan fan(mesh);
  FaceCoordinates coordinates;
  if (config.attributes) add_materials(header, input, mesh);
  for (const PlyElement& element : header.elements) {
    source.place = {&element, 0};
    if (element.count == 0) continue;
    if (element.name == "vertex") {
      read_vertices(source, header, element, config, mesh);
    } else if (element.name == "face" && config.attributes && header.has_textured_faces()) {
      TexturedFaces<Source>(source, header, element, mesh, fan, coordinates).read();
    } else if (element.name == "face") {
      read_faces(source, header, element, mesh, fan);
    } else if (element.name == "tristrips") {
      read_lists(source, element, 0,
                 [&](const PlyProperty& list) { read_strip(source, list, header.vertex_count(), mesh); });
    } else {
      skip_element(source, element);
    }
  }
  if (coordinates.uv_of.empty()) {
    fan.cut();
  } else {
    coordinates.uv_of.resize(mesh.triangles.size(), no_values);
    fan.cut(std::array{std::span(coordinates.uv_of)});
    share_corners(mesh, std::move(coordinates));
  }
  if (coordinates.faces_without > 0)
    mesh.warnings.push_back(describe(
        input.name(), "",
        std::to_string(coordinates.faces_without) + " faces do not have two texture coordinates for each corner"));
  add_ply_warnings(header, input.name(), config.attributes, source.bytes_left(), mesh.warnings);
  // Without texture numbers all faces have the first texture; strips have none.
  if (!mesh.materials.empty())
    mesh.wedges.material.resize(mesh.triangles.size(), mesh.wedges.material.empty() ? 0 : no_material);
  return mesh;
}

}  // namespace

RawMesh read_ply(ByteReader& input, const ReadConfig& config) {
  const PlyHeader header = read_ply_header(input);
  return header.byte_order ? read_body(PlyBinarySource(input, header), header, input, config)
                           : read_body(PlyTextSource(input, header), header, input, config);
}

}  // namespace lodestone
