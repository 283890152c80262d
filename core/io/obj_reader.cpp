// Wavefront OBJ: vertices and faces; every other statement is skipped.
#include <charconv>
#include <limits>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/io/mesh_readers.h"
#include "core/io/polygon_fan.h"
#include "core/io/text_scanner.h"

namespace lodestone {
namespace {

// The largest index that was ahead of the vertices read so far. Faces may come before their vertices, so that only the
// end of the file tells whether it is out of range.
struct ForwardReference {
  std::uint64_t index = 0, line = 0;
};

// The position in "v", "v/vt", "v//vn" or "v/vt/vn".
std::optional<std::int64_t> position_index(std::string_view corner) {
  return parse_integer(corner.substr(0, corner.find('/')));
}

Vec3d read_position(TextScanner& scan) {
  const double x = scan.number(scan.token(), "an x coordinate");
  const double y = scan.number(scan.token(), "a y coordinate");
  const double z = scan.number(scan.token(), "a z coordinate");
  return {x, y, z};  // a weight or a colour may follow
}

std::uint32_t read_corner(const TextScanner& scan, std::string_view token, std::uint64_t vertex_count,
                          ForwardReference& furthest) {
  const std::optional<std::int64_t> index = position_index(token);
  if (!index) scan.fail("expected a vertex index, found " + quote(token));
  if (*index == 0) scan.fail("vertex index 0", "OBJ counts vertices from 1");
  if (*index < 0) {
    const std::uint64_t back = 0 - static_cast<std::uint64_t>(*index);  // unsigned: -2^63 has no positive twin
    if (back > vertex_count)
      scan.fail("vertex index " + std::to_string(*index) + " goes back beyond the first of " +
                std::to_string(vertex_count) + " vertices");
    return static_cast<std::uint32_t>(vertex_count - back);
  }
  const std::uint64_t id = static_cast<std::uint64_t>(*index) - 1;
  if (id >= vertex_count && id >= furthest.index) furthest = {id, scan.line()};
  return static_cast<std::uint32_t>(id);
}

}  // namespace

RawMesh read_obj(ByteReader& input) {
  TextScanner scan(input);
  RawMesh mesh;
  PolygonFan fan(mesh);
  ForwardReference furthest;
  do {
    const std::string_view keyword = scan.token();
    if (keyword == "v") {
      if (mesh.positions.size() == std::numeric_limits<std::uint32_t>::max())
        throw ResourceError(describe(scan.name(), scan.place(), "more vertices than 32-bit indices reach",
                                     "split the model into several files"));
      mesh.positions.push_back(read_position(scan));
    } else if (keyword == "f") {
      for (std::string_view corner = scan.token(); !corner.empty(); corner = scan.token())
        fan.add(read_corner(scan, corner, mesh.positions.size(), furthest));
      fan.close();
    }
  } while (scan.next_line());
  if (furthest.line != 0 && furthest.index >= mesh.positions.size())
    throw InputError(describe(input.name(), "line " + std::to_string(furthest.line),
                              "vertex index " + std::to_string(furthest.index + 1) + " is out of range, the file has " +
                                  std::to_string(mesh.positions.size()) + " vertices",
                              "the file is damaged or truncated"));
  return mesh;
}

}  // namespace lodestone
