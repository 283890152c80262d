// PLY (Turk 1994), general reader: ASCII and binary bodies through one template, element by element in file order.
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/io/mesh_readers.h"
#include "core/io/ply_header.h"
#include "core/io/polygon_fan.h"
#include "core/io/text_scanner.h"

namespace lodestone {
namespace {

// What is being read, for messages: one element of a kind, counted from 0.
struct Place {
  const PlyElement* element = nullptr;
  std::uint64_t index = 0;
  [[nodiscard]] std::string text() const { return "element " + quote(element->name) + " " + std::to_string(index); }
};

constexpr const char* counts_may_be_wrong =
    "the element counts or properties of the header may be wrong, or the file is damaged";

// A body of text: values are words, wherever the line breaks are.
class AsciiSource {
 public:
  AsciiSource(ByteReader& input, const PlyHeader& header) : scan_(input, header.lines + 1) {}

  Place place;

  double number(const PlyProperty& property) {
    const std::string_view token = next();
    if (const std::optional<double> value = parse_number(token)) return *value;
    fail_expected("a number for " + quote(property.name), token);
  }
  std::int64_t integer(const PlyProperty& list) {
    const std::string_view token = next();
    if (const std::optional<std::int64_t> value = parse_integer(token)) return *value;
    fail_expected("an integer in the list " + quote(list.name), token);
  }
  std::int64_t length(const PlyProperty& list) {
    const std::string_view token = next();
    if (const std::optional<std::int64_t> value = parse_integer(token)) return *value;
    fail_expected("the length of the list " + quote(list.name), token);
  }
  void skip(ScalarType, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) (void)next();
  }
  [[noreturn]] void fail(const std::string& what, const std::string& remedy = {}) const {
    scan_.fail(place.text() + ": " + what, remedy);
  }

 private:
  // A word that does not fit is rarely a typing error: mostly the header announces more or other values than follow,
  // so that the reader is at another place of the file than it believes.
  [[noreturn]] void fail_expected(const std::string& what, std::string_view found) const {
    fail("expected " + what + ", found " + quote(found), counts_may_be_wrong);
  }
  std::string_view next() {
    const std::string_view token = scan_.token_across_lines();
    if (token.empty())
      fail(
          "the file ends before element " + std::to_string(place.index) + " of " + std::to_string(place.element->count),
          "it is truncated, or its header is damaged");
    return token;
  }
  TextScanner scan_;
};

class BinarySource {
 public:
  BinarySource(ByteReader& input, const PlyHeader& header) : input_(&input), order_(*header.byte_order) {}

  Place place;

  double number(const PlyProperty& property) { return value<double>(property.type); }
  std::int64_t integer(const PlyProperty& list) { return value<std::int64_t>(list.type); }
  std::int64_t length(const PlyProperty& list) { return value<std::int64_t>(*list.count_type); }
  void skip(ScalarType type, std::uint64_t count) {
    if (count > input_->remaining() / size_of(type)) fail_truncated();
    input_->skip(count * size_of(type));
  }
  [[noreturn]] void fail(const std::string& what, const std::string& remedy = {}) const {
    throw InputError(
        describe(input_->name(), place.text() + " at byte " + std::to_string(input_->offset()), what, remedy));
  }
  [[noreturn]] void fail_truncated() const {
    fail("the file ends before the " + std::to_string(place.element->count) + " elements it declares",
         "it is truncated, or its header is damaged");
  }
  [[nodiscard]] ByteReader& input() { return *input_; }

 private:
  template <class Value>
  Value value(ScalarType type) {
    const std::string_view bytes = input_->window(size_of(type));
    if (bytes.size() < size_of(type)) fail_truncated();
    const Value result = load_as<Value>(type, order_, bytes.data());
    input_->advance(size_of(type));
    return result;
  }
  ByteReader* input_;
  std::endian order_;
};

// The number of items of the list that comes next.
template <class Source>
std::uint64_t list_length(Source& source, const PlyProperty& list) {
  const std::int64_t length = source.length(list);
  if (length < 0) source.fail("a list of negative length", counts_may_be_wrong);
  return static_cast<std::uint64_t>(length);
}

template <class Source>
void skip_property(Source& source, const PlyProperty& property) {
  source.skip(property.type, property.count_type ? list_length(source, property) : 1);
}

// Binary records of fixed size, a window at a time. Returns how many it read.
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

template <class Source>
void read_vertices(Source& source, const PlyHeader& header, const PlyElement& element, RawMesh& mesh) {
  const PlyProperty* axes[3] = {element.find("x"), element.find("y"), element.find("z")};
  for (const PlyProperty* axis : axes)
    if (!axis || axis->count_type) source.fail("vertices without x, y and z", "this is no surface in space");
  mesh.positions.resize(element.count);
  if constexpr (std::is_same_v<Source, BinarySource>) {
    // A record longer than the window (thousands of properties) goes the general way.
    if (const auto layout = vertex_layout(header, element); layout && layout->stride <= ByteReader::max_window) {
      const std::uint64_t done =
          read_records(source, *layout, element.count, [&](auto bytes, std::size_t first, std::size_t count) {
            decode_vertices(*layout, bytes, std::span(mesh.positions).subspan(first, count));
            return count;
          });
      source.place.index = done;
      if (done < element.count) source.fail_truncated();
      return;
    }
  }
  for (std::uint64_t i = 0; i < element.count; ++i) {
    source.place.index = i;
    Vec3d& position = mesh.positions[i];
    double* const values[3] = {&position.x, &position.y, &position.z};
    for (const PlyProperty& property : element.properties) {
      const auto axis = std::find(axes, axes + 3, &property) - axes;
      if (axis < 3) {
        *values[axis] = source.number(property);
      } else {
        skip_property(source, property);
      }
    }
  }
}

template <class Source>
std::uint32_t checked_index(Source& source, std::int64_t index, std::uint64_t vertex_count) {
  if (index < 0 || static_cast<std::uint64_t>(index) >= vertex_count)
    source.fail("vertex index " + std::to_string(index) + " is out of range, the file has " +
                    std::to_string(vertex_count) + " vertices",
                counts_may_be_wrong);
  return static_cast<std::uint32_t>(index);
}

template <class Source>
void read_polygon(Source& source, const PlyProperty& list, std::uint64_t vertex_count, RawMesh& mesh) {
  PolygonFan fan(mesh);
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
  if (!indices) source.fail("without a list of vertex_indices", "only meshes of polygons or strips are read");
  if (!is_integer(indices->type)) source.fail("vertex indices that are no integers", "the header is damaged");
  return indices;
}

// Faces or strips from number `first` on: `read_list` takes the list of vertex indices, everything else is skipped.
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
void read_faces(Source& source, const PlyHeader& header, const PlyElement& element, RawMesh& mesh) {
  const std::uint64_t vertex_count = header.vertex_count();
  (void)index_list(source, element);  // before memory is reserved for elements that may be of zero size
  mesh.triangles.reserve(mesh.triangles.size() + element.count);
  std::uint64_t done = 0;
  if constexpr (std::is_same_v<Source, BinarySource>) {
    // The fast kernel takes the triangles up to the first face that is none; what follows goes the general way.
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
  read_lists(source, element, done, [&](const PlyProperty& list) { read_polygon(source, list, vertex_count, mesh); });
}

template <class Source>
void skip_element(Source& source, const PlyElement& element) {
  if (element.properties.empty()) return;  // any number of nothing
  for (std::uint64_t i = 0; i < element.count; ++i) {
    source.place.index = i;
    for (const PlyProperty& property : element.properties) skip_property(source, property);
  }
}

template <class Source>
RawMesh read_body(Source source, const PlyHeader& header) {
  RawMesh mesh;
  for (const PlyElement& element : header.elements) {
    source.place = {&element, 0};
    if (element.count == 0) continue;
    if (element.name == "vertex") {
      read_vertices(source, header, element, mesh);
    } else if (element.name == "face") {
      read_faces(source, header, element, mesh);
    } else if (element.name == "tristrips") {
      read_lists(source, element, 0,
                 [&](const PlyProperty& list) { read_strip(source, list, header.vertex_count(), mesh); });
    } else {
      skip_element(source, element);
    }
  }
  return mesh;
}

}  // namespace

RawMesh read_ply(ByteReader& input) {
  const PlyHeader header = read_ply_header(input);
  return header.byte_order ? read_body(BinarySource(input, header), header)
                           : read_body(AsciiSource(input, header), header);
}

}  // namespace lodestone
