#include "core/formats/plain/stl.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <limits>
#include <sstream>
#include <string>

#include "core/base/error.h"
#include "core/files/text_scanner.h"
#include "core/formats/common/float_range.h"
#include "core/formats/common/polygon_fan.h"

namespace lodestone {
namespace {

constexpr const char* truncated = "the file is truncated";

bool begins_with_solid(std::string_view head) {
  const std::size_t first = std::min(head.find_first_not_of(" \t\r\n"), head.size());
  return lower_case(head.substr(first, 5)) == "solid";
}

[[noreturn]] void fail_too_large(const ByteReader& input) {
  throw ResourceError(describe(input.name(), "", "more corners than 32-bit indices reach",
                               "weld it into a PLY file, or split it into several files"));
}

RawMesh read_binary(ByteReader& input) {
  const std::uint64_t size = input.size();
  if (size < stl_header_bytes)
    throw InputError(
        describe(input.name(), "header", "the file has only " + std::to_string(size) + " of 84 bytes", truncated));
  const std::uint64_t facets = declared_stl_facets(input.window(stl_header_bytes));
  const std::uint64_t held = (size - stl_header_bytes) / stl_facet_bytes;
  if (facets > held)
    throw InputError(describe(input.name(), "byte 80",
                              "declares " + std::to_string(facets) + " facets, but has " + std::to_string(held),
                              truncated));
  if (3 * facets > std::numeric_limits<std::uint32_t>::max()) fail_too_large(input);
  input.skip(stl_header_bytes);
  RawMesh mesh;
  mesh.positions.resize(3 * facets);
  mesh.triangles.resize(facets);
  for (std::uint64_t first = 0; first < facets;) {
    const std::string_view bytes = input.window(stl_facet_bytes);
    const std::uint64_t count = std::min<std::uint64_t>(bytes.size() / stl_facet_bytes, facets - first);
    if (count == 0)
      throw InputError(describe(input.name(), "facet " + std::to_string(first), "the file has shrunk", truncated));
    decode_stl_corners(bytes, std::span(mesh.positions).subspan(3 * first, 3 * count));
    input.advance(count * stl_facet_bytes);
    first += count;
  }
  number_corners(mesh.triangles, 0);
  return mesh;
}

Vec3d unit_normal(Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d normal = cross(b - a, c - a);
  const double size = length(normal);
  return size > 0 ? (1 / size) * normal : Vec3d{};  // readers compute a normal that is (0, 0, 0)
}

// A note on the rounding of coordinates, if it exceeds the one that every vertex has in memory: far from the origin, or
// near the ends of the range of float.
std::string rounding_note(const MeshView& mesh, const std::string& name) {
  constexpr double kept = 0x1p-22;  // of the longest extent
  if (mesh.vertex_count == 0) return {};
  const FloatRounding rounding = float_rounding(box_of(mesh));
  if (!(rounding.moved > kept * rounding.extent)) return {};
  std::ostringstream text;
  text.exceptions(std::ios::badbit);  // no memory
  text.precision(2);
  text << "the model is " << rounding.so() << " that STL, which has float32 alone, ";
  if (rounding.moved < rounding.largest) {
    text << "moves its vertices by up to " << rounding.moved << " (" << 100 * (rounding.moved / rounding.extent)
         << " % of its extent)";
  } else {
    text << "cannot hold it";
  }
  const std::string remedy = rounding.is_far() ? "write a .ply, .obj or .glb file" : "write a .ply or .obj file";
  if (rounding.destroys()) throw InputError(describe(name, "", text.str(), remedy));
  return describe(name, "", text.str(), remedy);
}

class AsciiStl {
 public:
  explicit AsciiStl(ByteReader& input) : input_(&input), scan_(input), fan_(mesh_) {}

  RawMesh read() {
    while (true) {
      const std::string keyword = word();
      if (keyword == "solid") {
        in_solid_ = true;
        scan_.next_line();  // a name of any number of words
      } else if (keyword == "endsolid") {
        in_solid_ = false;
        if (!scan_.next_line()) return finished();
      } else if (keyword.empty()) {
        if (in_solid_) scan_.fail("the file ends without 'endsolid'", truncated);
        return finished();
      } else if (in_solid_ && keyword == "facet") {
        read_facet();
      } else {
        scan_.fail("expected 'facet' or 'endsolid', found " + quote(keyword), "the file is damaged");
      }
    }
  }

 private:
  RawMesh finished() {
    fan_.cut();
    return std::move(mesh_);
  }

  void read_facet() {
    expect("normal");
    for (int i = 0; i < 3; ++i) (void)scan_.number(scan_.token_across_lines(), "a normal");
    expect("outer");
    expect("loop");
    std::string keyword = word();
    for (; keyword == "vertex"; keyword = word()) read_vertex();
    if (keyword != "endloop") scan_.fail("expected 'vertex' or 'endloop', found " + quote(keyword), truncated);
    fan_.close();
    expect("endfacet");
  }

  void read_vertex() {
    if (mesh_.positions.size() == std::numeric_limits<std::uint32_t>::max()) fail_too_large(*input_);
    const double x = scan_.number(scan_.token_across_lines(), "an x coordinate");
    const double y = scan_.number(scan_.token_across_lines(), "a y coordinate");
    const double z = scan_.number(scan_.token_across_lines(), "a z coordinate");
    fan_.add(static_cast<std::uint32_t>(mesh_.positions.size()));
    mesh_.positions.push_back({x, y, z});
  }

  void expect(std::string_view keyword) {
    const std::string found = word();
    if (found != keyword)
      scan_.fail("expected '" + std::string(keyword) + "', found " + (found.empty() ? "the end" : quote(found)),
                 truncated);
  }

  // The next word in lower case: writers differ.
  std::string word() { return lower_case(scan_.token_across_lines()); }

  ByteReader* input_;
  TextScanner scan_;
  RawMesh mesh_;
  PolygonFan fan_;
  bool in_solid_ = false;
};

}  // namespace

bool is_binary_stl(std::string_view head, std::uint64_t size) {
  if (head.size() >= stl_header_bytes && size == stl_header_bytes + stl_facet_bytes * declared_stl_facets(head))
    return true;
  // The size fits no facet count, so it is text or damaged; text has no zero bytes, and the header of a binary file
  // that begins with "solid" is padded with them.
  return !begins_with_solid(head) || head.find('\0') != std::string_view::npos;
}

bool is_complete_stl(std::string_view head, std::uint64_t size) {
  if (head.size() < stl_header_bytes) return false;
  const std::uint64_t facets = declared_stl_facets(head);
  return facets > 0 && size >= stl_header_bytes + stl_facet_bytes * facets;
}

RawMesh read_stl(ByteReader& input) {
  return is_binary_stl(input.window(stl_header_bytes), input.size()) ? read_binary(input) : AsciiStl(input).read();
}

std::string write_stl(AtomicFile& file, const MeshView& mesh, const std::string& name) {
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max())
    throw ResourceError(describe(name, "", "more triangles than an STL file can count", "write a .ply file"));
  std::string note = rounding_note(mesh, name);
  std::array<char, 80> header{};
  std::strcpy(header.data(), "binary STL by Lodestone");
  file.write(std::as_bytes(std::span(header)));
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  file.write(std::as_bytes(std::span(&count, 1)));
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.position(t.v[0]), b = mesh.position(t.v[1]), c = mesh.position(t.v[2]);
    std::array<std::byte, stl_facet_bytes> record{};
    const std::array<Vec3f, 4> vectors{to_float(unit_normal(a, b, c)), to_float(a), to_float(b), to_float(c)};
    std::memcpy(record.data(), vectors.data(), sizeof vectors);
    file.write(record);
  }
  return note;
}

void decode_stl_corners(std::span<const char> bytes, std::span<Vec3d> out) {
  assert(out.size() % 3 == 0 && bytes.size() >= out.size() / 3 * stl_facet_bytes);
  const char* record = bytes.data();
  for (std::size_t i = 0; i < out.size(); i += 3, record += stl_facet_bytes) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const char* xyz = record + 12 + 12 * corner;
      out[i + corner] = {load<float>(xyz), load<float>(xyz + 4), load<float>(xyz + 8)};
    }
  }
}

void number_corners(std::span<Triangle> out, std::uint64_t first) {
  auto corner = static_cast<std::uint32_t>(first);
  for (Triangle& triangle : out) {
    triangle = {{corner, corner + 1, corner + 2}};
    corner += 3;
  }
}

}  // namespace lodestone
