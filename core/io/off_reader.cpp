// OFF, the object file format of Geomview. Positions come first on every vertex line, so that normals, colours and
// texture coordinates behind them need no look; colours of faces likewise.
#include <limits>
#include <string>

#include "core/base/error.h"
#include "core/io/mesh_readers.h"
#include "core/io/polygon_fan.h"
#include "core/io/text_scanner.h"

namespace lodestone {
namespace {

constexpr const char* truncated = "the file is truncated, or its header is damaged";

// [ST][C][N][4][n]OFF
void read_keyword(TextScanner& scan) {
  const std::string keyword(scan.token_across_lines());
  std::string_view prefix = keyword;
  if (!prefix.ends_with("OFF"))
    scan.fail("does not begin with 'OFF' but with " + quote(keyword), "this is no OFF file");
  prefix.remove_suffix(3);
  const auto refuse = [&](const std::string& what) {
    throw UnsupportedError(
        describe(scan.name(), scan.place(), what, "convert it to a text OFF file in three dimensions"));
  };
  if (prefix.ends_with("n") || prefix.ends_with("4")) refuse("OFF of other than three dimensions");
  for (const std::string_view part : {"ST", "C", "N"})
    if (prefix.starts_with(part)) prefix.remove_prefix(part.size());
  if (!prefix.empty()) scan.fail("unknown keyword " + quote(keyword), "this is no OFF file");
}

std::uint64_t read_count(TextScanner& scan, const char* what) {
  const std::string_view token = scan.token_across_lines();
  if (token == "BINARY")
    throw UnsupportedError(describe(scan.name(), scan.place(), "binary OFF", "convert it to a text OFF file"));
  const std::int64_t count = scan.integer(token, what);
  if (count < 0) scan.fail(std::string("a negative number where ") + what + " is expected", truncated);
  return static_cast<std::uint64_t>(count);
}

// A vertex takes at least "0 0 0\n", a face "0\n"; the last line may lack its end.
void check_counts(const TextScanner& scan, std::uint64_t vertices, std::uint64_t faces, std::uint64_t bytes) {
  if (vertices > (bytes + 1) / 6 || faces > (bytes + 1 - 6 * vertices) / 2)
    scan.fail("declares " + std::to_string(vertices) + " vertices and " + std::to_string(faces) + " faces, but only " +
                  std::to_string(bytes) + " bytes follow",
              truncated);
  if (vertices > std::numeric_limits<std::uint32_t>::max())
    throw ResourceError(describe(scan.name(), scan.place(), "more vertices than 32-bit indices reach",
                                 "split the model into several files"));
}

Vec3d read_position(TextScanner& scan) {
  const double x = scan.number(scan.token_across_lines(), "an x coordinate");
  const double y = scan.number(scan.token(), "a y coordinate");
  const double z = scan.number(scan.token(), "a z coordinate");
  scan.next_line();
  return {x, y, z};
}

void read_face(TextScanner& scan, std::uint64_t vertex_count, PolygonFan& fan) {
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
  scan.next_line();
}

}  // namespace

RawMesh read_off(ByteReader& input) {
  TextScanner scan(input);
  read_keyword(scan);
  const std::uint64_t vertices = read_count(scan, "the number of vertices");
  const std::uint64_t faces = read_count(scan, "the number of faces");
  check_counts(scan, vertices, faces, input.remaining());
  scan.next_line();  // the number of edges, which many writers leave at 0 or out
  RawMesh mesh;
  mesh.positions.reserve(vertices);
  mesh.triangles.reserve(faces);
  for (std::uint64_t i = 0; i < vertices; ++i) mesh.positions.push_back(read_position(scan));
  PolygonFan fan(mesh);
  for (std::uint64_t i = 0; i < faces; ++i) read_face(scan, vertices, fan);
  return mesh;
}

}  // namespace lodestone
