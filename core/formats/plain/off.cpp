// OFF, the object file format of Geomview. A vertex is a line: position, then what the keyword announces, in the order
// normal (N), colour (C), texture coordinate (ST). Colours of faces are left out.
#include "core/formats/plain/off.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/files/text_scanner.h"
#include "core/formats/common/lower_left.h"
#include "core/formats/common/polygon_fan.h"
#include "core/mesh/raw_mesh.h"
#include "core/texture/colour.h"

namespace lodestone {
namespace {

constexpr const char* cut_short = "the file is truncated, or its header is damaged";

// Attributes that follow the position on the line of a vertex.
struct OffForm {
  bool uv = false, colour = false, normal = false;
};

// [ST][C][N][4][n]OFF
OffForm read_keyword(TextScanner& scan) {
  const std::string keyword(scan.token_across_lines());
  std::string_view prefix = keyword;
  if (!prefix.ends_with("OFF"))
    scan.fail("the file does not begin with 'OFF' but with " + quote(keyword), "this is not an OFF file");
  prefix.remove_suffix(3);
  const auto refuse = [&](const std::string& what) {
    throw UnsupportedError(
        describe(scan.name(), scan.place(), what, "convert it to a text OFF file in three dimensions"));
  };
  if (prefix.ends_with("n") || prefix.ends_with("4")) refuse("OFF of other than three dimensions");
  const auto take = [&](std::string_view part) {
    if (!prefix.starts_with(part)) return false;
    prefix.remove_prefix(part.size());
    return true;
  };
  const bool uv = take("ST"), colour = take("C"), normal = take("N");
  if (!prefix.empty()) scan.fail("unknown keyword " + quote(keyword), "this is not an OFF file");
  return {uv, colour, normal};
}

std::uint64_t read_count(TextScanner& scan, const char* what) {
  const std::string_view token = scan.token_across_lines();
  if (token == "BINARY")
    throw UnsupportedError(describe(scan.name(), scan.place(), "binary OFF", "convert it to a text OFF file"));
  const std::int64_t count = scan.integer(token, what);
  if (count < 0) scan.fail(std::string(what) + " is negative", cut_short);
  return static_cast<std::uint64_t>(count);
}

// A vertex takes at least "0 0 0\n", a face "0\n"; the last line may lack its end.
void check_counts(const TextScanner& scan, std::uint64_t vertices, std::uint64_t faces, std::uint64_t bytes) {
  if (vertices > (bytes + 1) / 6 || faces > (bytes + 1 - 6 * vertices) / 2)
    scan.fail("declares " + std::to_string(vertices) + " vertices and " + std::to_string(faces) + " faces, but only " +
                  std::to_string(bytes) + " bytes follow",
              cut_short);
  if (vertices > std::numeric_limits<std::uint32_t>::max())
    throw ResourceError(describe(scan.name(), scan.place(), "more vertices than 32-bit indices reach",
                                 "split the model into several files"));
}

// Collects attributes line by line. Lines that lack one are counted and get its absent value.
class OffAttributes {
 public:
  OffAttributes(const OffForm& form, RawMesh& mesh) : form_(form), mesh_(mesh) {}

  // The numbers that follow the position on the line.
  void read(TextScanner& scan) {
    if (!form_.uv && !form_.colour && !form_.normal) return;
    std::array<double, 9> values{};
    std::size_t count = 0, at = 0;
    for (std::string_view token = scan.token(); !token.empty() && count < values.size(); token = scan.token()) {
      const std::optional<double> value = parse_number(token);
      if (!value) break;
      values[count++] = *value;
    }
    bool complete = true;
    if (form_.normal) {
      const bool there = count >= 3;
      mesh_.wedges.normal.push_back(there ? unit_normal({values[0], values[1], values[2]}) : Vec3f{});
      at = there ? 3 : 0;
      complete = complete && there;
    }
    if (form_.colour) {
      const std::size_t left = count - at, components = form_.uv && left >= 2 ? left - 2 : left;
      const bool there = components == 3 || components == 4;
      colours_.push_back(there ? std::optional(std::array{values[at], values[at + 1], values[at + 2],
                                                          components == 4 ? values[at + 3] : std::nan("")})
                               : std::nullopt);
      at += there ? components : 0;
      complete = complete && there;
    }
    if (form_.uv) {
      const bool there = count - at >= 2;
      mesh_.wedges.uv.push_back(there ? from_lower_left(values[at], values[at + 1]) : Vec2f{});
      complete = complete && there;
    }
    incomplete_ += !complete;
  }

  // Colours count to 255, but to 1 in a file that has fractions, or nothing above 1.
  void finish(const std::string& file) {
    bool to_one = false;
    double largest = 0;
    for (const auto& colour : colours_)
      for (const double component : colour.value_or(std::array<double, 4>{})) {
        if (std::isnan(component)) continue;
        to_one = to_one || component != std::floor(component);
        largest = std::max(largest, component);
      }
    const double scale = to_one || largest <= 1 ? 1 : 1.0 / 255;
    for (const auto& colour : colours_) {
      if (!colour) {
        mesh_.wedges.colour.push_back({});
        continue;
      }
      const auto byte = [&](std::size_t k) { return unit_to_byte(scale * (*colour)[k]); };
      mesh_.wedges.colour.push_back(
          {byte(0), byte(1), byte(2), std::isnan((*colour)[3]) ? std::uint8_t{255} : byte(3)});
    }
    if (incomplete_ > 0)
      mesh_.warnings.push_back(
          describe(file, "", std::to_string(incomplete_) + " vertices lack attributes that the keyword announces"));
  }

 private:
  OffForm form_;
  RawMesh& mesh_;
  std::vector<std::optional<std::array<double, 4>>> colours_;  // as written; NaN: no alpha
  std::uint64_t incomplete_ = 0;
};

Vec3d read_position(TextScanner& scan) {
  const double x = scan.number(scan.token_across_lines(), "an x coordinate");
  const double y = scan.number(scan.token(), "a y coordinate");
  const double z = scan.number(scan.token(), "a z coordinate");
  return {x, y, z};
}

// True if something follows the corners: a colour.
bool read_face(TextScanner& scan, std::uint64_t vertex_count, PolygonFan& fan) {
  const std::int64_t corners = scan.integer(scan.token_across_lines(), "the number of corners of a face");
  if (corners < 0) scan.fail("a negative number of corners");
  for (std::int64_t i = 0; i < corners; ++i) {
    const std::int64_t index = scan.integer(scan.token_across_lines(), "a vertex index");
    if (index < 0 || static_cast<std::uint64_t>(index) >= vertex_count)
      scan.fail("vertex index " + std::to_string(index) + " is out of range, the file has " +
                std::to_string(vertex_count) + " vertices");
    fan.add(static_cast<std::uint32_t>(index));
  }
  fan.close();
  const bool coloured = scan.line_continues() && !scan.token().empty();
  scan.next_line();
  return coloured;
}

}  // namespace

RawMesh read_off(ByteReader& input, const ReadConfig& config) {
  TextScanner scan(input);
  const OffForm form = read_keyword(scan);
  const std::uint64_t vertices = read_count(scan, "the number of vertices");
  const std::uint64_t faces = read_count(scan, "the number of faces");
  check_counts(scan, vertices, faces, input.remaining());
  scan.next_line();  // the number of edges, which many writers leave at 0 or out
  RawMesh mesh;
  mesh.positions.reserve(vertices);
  mesh.triangles.reserve(faces);
  OffAttributes attributes(config.attributes ? form : OffForm{}, mesh);
  for (std::uint64_t i = 0; i < vertices; ++i) {
    mesh.positions.push_back(read_position(scan));
    attributes.read(scan);
    scan.next_line();
  }
  attributes.finish(input.name());
  PolygonFan fan(mesh);
  std::uint64_t coloured = 0;
  for (std::uint64_t i = 0; i < faces; ++i) coloured += read_face(scan, vertices, fan);
  fan.cut();
  if (coloured > 0 && config.attributes)
    mesh.warnings.push_back(
        describe(input.name(), "", "the colours of " + std::to_string(coloured) + " faces are left out"));
  return mesh;
}

}  // namespace lodestone
