#include "core/formats/ply/ply_header.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/files/text_scanner.h"

namespace lodestone {
namespace {

constexpr std::array<std::pair<std::string_view, ScalarType>, 16> type_names{{
    {"char", ScalarType::int8},
    {"int8", ScalarType::int8},
    {"uchar", ScalarType::uint8},
    {"uint8", ScalarType::uint8},
    {"short", ScalarType::int16},
    {"int16", ScalarType::int16},
    {"ushort", ScalarType::uint16},
    {"uint16", ScalarType::uint16},
    {"int", ScalarType::int32},
    {"int32", ScalarType::int32},
    {"uint", ScalarType::uint32},
    {"uint32", ScalarType::uint32},
    {"float", ScalarType::float32},
    {"float32", ScalarType::float32},
    {"double", ScalarType::float64},
    {"float64", ScalarType::float64},
}};

constexpr const char* damaged = "the header is damaged, or this is not a PLY file";

ScalarType parse_type(const TextScanner& scan, std::string_view token) {
  for (const auto& [name, type] : type_names)
    if (name == token) return type;
  scan.fail("unknown property type " + quote(token), damaged);
}

std::string parse_name(TextScanner& scan, const char* what) {
  const std::string_view token = scan.token();
  if (token.empty()) scan.fail(std::string("expected ") + what + ", found the end of the line", damaged);
  return std::string(token);
}

std::optional<std::endian> parse_format(TextScanner& scan) {
  const std::string format(scan.token());
  const std::string version(scan.token());
  if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian")
    scan.fail("unknown format " + quote(format), damaged);
  if (version != "1.0")
    throw UnsupportedError(describe(scan.name(), scan.place(), "PLY version " + quote(version) + " is not known",
                                    "save the file as PLY 1.0"));
  if (format == "ascii") return std::nullopt;
  return format == "binary_big_endian" ? std::endian::big : std::endian::little;
}

PlyElement parse_element(TextScanner& scan, const PlyHeader& header) {
  PlyElement element;
  element.name = parse_name(scan, "an element name");
  const std::int64_t count = scan.integer(scan.token(), "the number of elements");
  if (count < 0) scan.fail("the number of elements is negative", damaged);
  element.count = static_cast<std::uint64_t>(count);
  if (header.find(element.name)) scan.fail("element " + quote(element.name) + " is declared twice", damaged);
  return element;
}

PlyProperty parse_property(TextScanner& scan) {
  PlyProperty property;
  std::string_view token = scan.token();
  if (token == "list") {
    property.count_type = parse_type(scan, scan.token());
    if (!is_integer(*property.count_type)) scan.fail("the length of a list has to be an integer", damaged);
    token = scan.token();
  }
  property.type = parse_type(scan, token);
  property.name = parse_name(scan, "a property name");
  return property;
}

void check_counts(const PlyHeader& header, const ByteReader& input) {
  // An ASCII file may lack the separator after its last value.
  std::uint64_t left = input.remaining() + (header.byte_order ? 0 : 1);
  for (const PlyElement& element : header.elements) {
    const std::uint64_t each = element.min_bytes(!header.byte_order);
    if (each != 0 && element.count > left / each)
      throw InputError(describe(input.name(), "header",
                                "declares " + std::to_string(element.count) + " of element " + quote(element.name) +
                                    ", at least " + std::to_string(each) + " bytes each, but only " +
                                    std::to_string(left) + " bytes follow",
                                "the file is truncated or its header is damaged"));
    left -= element.count * each;
  }
  if (header.vertex_count() > std::numeric_limits<std::uint32_t>::max())
    throw ResourceError(describe(input.name(), "header", "more vertices than 32-bit indices reach",
                                 "split the model into several files"));
}

// Bytes from the start of an element's record to the property; empty when a list comes before it.
std::optional<std::size_t> offset_of(const PlyElement& element, const PlyProperty& property) {
  std::size_t offset = 0;
  for (const PlyProperty& before : element.properties) {
    if (&before == &property) return offset;
    if (before.count_type) return std::nullopt;
    offset += size_of(before.type);
  }
  return std::nullopt;
}

bool has_list(const PlyElement& element) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [](const PlyProperty& property) { return property.count_type.has_value(); });
}

}  // namespace

const PlyProperty* PlyElement::find(std::string_view property) const {
  for (const PlyProperty& candidate : properties)
    if (candidate.name == property) return &candidate;
  return nullptr;
}

const PlyProperty* PlyElement::index_list() const {
  for (const std::string_view list : {"vertex_indices", "vertex_index"})
    if (const PlyProperty* found = find(list); found && found->count_type) return found;
  return nullptr;
}

const PlyProperty* PlyElement::texture_coordinate_list() const {
  const PlyProperty* list = find("texcoord");
  return list && list->count_type ? list : nullptr;
}

const PlyProperty* PlyElement::texture_number() const {
  const PlyProperty* number = find("texnumber");
  return number && !number->count_type && is_integer(number->type) ? number : nullptr;
}

PlyVertexAttributes vertex_attributes(const PlyElement& vertex) {
  const auto all_of = [&](std::initializer_list<std::string_view> names) {
    std::vector<const PlyProperty*> found;
    for (const std::string_view name : names)
      if (const PlyProperty* property = vertex.find(name); property && !property->count_type) found.push_back(property);
    if (found.size() != names.size()) found.clear();
    return found;
  };
  PlyVertexAttributes attributes{.normal = all_of({"nx", "ny", "nz"}), .colour = {}, .uv = {}};
  attributes.colour = all_of({"red", "green", "blue", "alpha"});
  if (attributes.colour.empty()) attributes.colour = all_of({"red", "green", "blue"});
  attributes.uv = all_of({"s", "t"});
  if (attributes.uv.empty()) attributes.uv = all_of({"u", "v"});
  if (attributes.uv.empty()) attributes.uv = all_of({"texture_u", "texture_v"});
  return attributes;
}

std::uint64_t PlyElement::min_bytes(bool ascii) const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : properties)
    bytes += ascii ? 2 : size_of(property.count_type.value_or(property.type));  // a digit and a separator
  return bytes;
}

const PlyElement* PlyHeader::find(std::string_view element) const {
  for (const PlyElement& candidate : elements)
    if (candidate.name == element) return &candidate;
  return nullptr;
}

std::uint64_t PlyHeader::vertex_count() const {
  const PlyElement* vertex = find("vertex");
  return vertex ? vertex->count : 0;
}

bool PlyHeader::has_textured_faces() const {
  const PlyElement* face = find("face");
  return face && (face->texture_coordinate_list() || (!textures.empty() && face->texture_number()));
}

PlyHeader read_ply_header(ByteReader& input) {
  TextScanner scan(input);
  PlyHeader header;
  if (scan.token() != "ply") scan.fail("the file does not begin with 'ply'", "this is not a PLY file");
  bool has_format = false, complete = false;
  while (!complete && scan.next_line()) {
    const std::string keyword(scan.token());
    if (keyword == "format") {
      header.byte_order = parse_format(scan);
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(parse_element(scan, header));
    } else if (keyword == "property") {
      if (header.elements.empty()) scan.fail("a property comes before the first element", damaged);
      header.elements.back().properties.push_back(parse_property(scan));
    } else if (keyword == "comment") {
      if (scan.continues_with("TextureFile ") && !scan.token().empty()) header.textures.push_back(scan.rest_of_line());
    } else if (keyword == "end_header") {
      complete = true;
    } else if (!keyword.empty() && keyword != "obj_info" && !header.elements.empty()) {
      // Before the first element unknown lines are accepted: some exporters forget the word "comment" there.
      scan.fail("unknown keyword " + quote(keyword), damaged);
    }
  }
  if (!complete) scan.fail("the header does not end", damaged);
  if (!has_format) scan.fail("the header names no format", damaged);
  header.lines = scan.line();
  scan.next_line();
  header.data_offset = input.offset();
  check_counts(header, input);
  return header;
}

std::optional<VertexLayout> vertex_layout(const PlyHeader& header, const PlyElement& vertex) {
  if (!header.byte_order || has_list(vertex)) return std::nullopt;
  VertexLayout layout{.stride = vertex.min_bytes(false), .coordinates = {}, .byte_order = *header.byte_order};
  constexpr std::array<std::string_view, 3> names{"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const PlyProperty* property = vertex.find(names[axis]);
    if (!property) return std::nullopt;
    layout.coordinates[axis] = {*offset_of(vertex, *property), property->type};
  }
  return layout;
}

VertexAttributeLayout vertex_attribute_layout(const PlyHeader& header, const PlyElement& vertex) {
  const PlyVertexAttributes attributes = vertex_attributes(vertex);
  const auto places = [&](const std::vector<const PlyProperty*>& properties) {
    std::vector<VertexAttributeLayout::Value> values;
    for (const PlyProperty* property : properties) values.push_back({*offset_of(vertex, *property), property->type});
    return values;
  };
  return {.stride = vertex.min_bytes(false),
          .normal = places(attributes.normal),
          .colour = places(attributes.colour),
          .uv = places(attributes.uv),
          .byte_order = *header.byte_order};
}

std::optional<TriangleLayout> triangle_layout(const PlyHeader& header, const PlyElement& face) {
  const PlyProperty* list = face.index_list();
  if (!header.byte_order || !list || size_of(*list->count_type) != 1) return std::nullopt;
  if (list->type != ScalarType::int32 && list->type != ScalarType::uint32) return std::nullopt;
  const bool other_lists = std::count_if(face.properties.begin(), face.properties.end(),
                                         [](const PlyProperty& p) { return p.count_type.has_value(); }) > 1;
  if (other_lists) return std::nullopt;
  return TriangleLayout{.stride = face.min_bytes(false) + 3 * size_of(list->type),
                        .count_offset = *offset_of(face, *list),
                        .byte_order = *header.byte_order};
}

std::optional<PlyFixedLayout> fixed_layout(const PlyHeader& header) {
  const PlyElement* vertex = header.find("vertex");
  const PlyElement* face = header.find("face");
  if (!vertex || !face || header.find("tristrips")) return std::nullopt;
  const std::optional<VertexLayout> vertices = vertex_layout(header, *vertex);
  const std::optional<TriangleLayout> triangles = triangle_layout(header, *face);
  if (!vertices || !triangles) return std::nullopt;
  PlyFixedLayout layout{
      .vertices = *vertices, .attributes = vertex_attribute_layout(header, *vertex), .triangles = *triangles};
  layout.vertex_count = vertex->count;
  layout.triangle_count = face->count;
  std::uint64_t offset = header.data_offset;
  for (const PlyElement& element : header.elements) {
    if (&element == face) {
      layout.triangle_offset = offset;
      offset += face->count * triangles->stride;
      continue;
    }
    if (has_list(element)) return std::nullopt;  // the offset after it is not known without reading it
    if (&element == vertex) layout.vertex_offset = offset;
    offset += element.count * element.min_bytes(false);
  }
  layout.end = offset;
  return layout;
}

namespace {

// "quality radius of vertices, flags of faces, 3 of element material": what the readers skip, besides colours of faces.
std::string names_left_out(const PlyHeader& header) {
  std::string all;
  const auto add = [&](const std::string& what) { all += (all.empty() ? "" : ", ") + what; };
  const auto add_properties = [&](const PlyElement& element, const std::vector<const PlyProperty*>& read,
                                  const char* of) {
    std::string names;
    for (const PlyProperty& p : element.properties)
      if (std::ranges::find(read, &p) == read.end()) names += (names.empty() ? "" : " ") + p.name;
    if (!names.empty()) add(names + of);
  };
  for (const PlyElement& element : header.elements) {
    if (element.count == 0) continue;
    if (element.name == "vertex") {
      const PlyVertexAttributes attributes = vertex_attributes(element);
      std::vector<const PlyProperty*> read{element.find("x"), element.find("y"), element.find("z")};
      for (const auto* list : {&attributes.normal, &attributes.colour, &attributes.uv})
        read.insert(read.end(), list->begin(), list->end());
      add_properties(element, read, " of vertices");
    } else if (element.name == "face") {
      std::vector<const PlyProperty*> read{element.index_list(), element.texture_coordinate_list()};
      if (!header.textures.empty()) read.push_back(element.texture_number());
      for (const char* channel : {"red", "green", "blue", "alpha"}) read.push_back(element.find(channel));
      add_properties(element, read, " of faces");
    } else if (element.name != "tristrips") {
      add(std::to_string(element.count) + " of element " + element.name);
    }
  }
  return all;
}

}  // namespace

void add_ply_warnings(const PlyHeader& header, const std::string& name, bool attributes, std::uint64_t bytes_after,
                      std::vector<std::string>& warnings) {
  const PlyElement* face = header.find("face");
  if (attributes && face && face->count > 0 && face->find("red"))
    warnings.push_back(describe(name, "header", "the colours of the faces are left out; those of vertices are read"));
  if (const std::string left_out = attributes ? names_left_out(header) : ""; !left_out.empty())
    warnings.push_back(describe(name, "header", left_out + " left out"));
  if (bytes_after > 0)
    warnings.push_back(describe(name, "", std::to_string(bytes_after) + " bytes after the last element are left out",
                                "check its count"));
}

}  // namespace lodestone
