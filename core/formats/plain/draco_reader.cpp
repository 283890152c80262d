// Draco compressed meshes (.drc).
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/formats/common/colour.h"
#include "core/formats/common/mesh_readers.h"
#include "core/formats/plain/draco_mesh.h"
#include "core/mesh/raw_mesh.h"

namespace lodestone {
namespace {

// Wedges are points; every attribute has a value at each.
RawWedges read_wedges(const DracoMesh& source, std::vector<Triangle>&& point_triangles) {
  using Kind = DracoMesh::Kind;
  RawWedges wedges;
  if (const auto normal = source.find(Kind::normal); normal && normal->components == 3) {
    const std::vector<double> values = source.values(*normal, 3);
    wedges.normal.reserve(source.point_count());
    for (std::size_t i = 0; i < values.size(); i += 3)
      wedges.normal.push_back(unit_normal({values[i], values[i + 1], values[i + 2]}));
  }
  if (const auto colour = source.find(Kind::colour); colour && colour->components >= 3) {
    const std::vector<double> values = source.values(*colour, 4);
    const auto byte = [&](double value) { return unit_to_byte(value / colour->largest); };
    wedges.colour.reserve(source.point_count());
    for (std::size_t i = 0; i < values.size(); i += 4)
      wedges.colour.push_back({byte(values[i]), byte(values[i + 1]), byte(values[i + 2]),
                               colour->components > 3 ? byte(values[i + 3]) : std::uint8_t{255}});
  }
  if (const auto uv = source.find(Kind::texture_coordinate); uv && uv->components >= 2) {
    const std::vector<double> values = source.values(*uv, 2);
    wedges.uv.reserve(source.point_count());
    for (std::size_t i = 0; i < values.size(); i += 2) wedges.uv.push_back(from_lower_left(values[i], values[i + 1]));
  }
  if (!wedges.empty()) wedges.corners = std::move(point_triangles);
  return wedges;
}

}  // namespace

RawMesh read_draco(ByteReader& input, const ReadConfig& config) {
  const std::vector<char> bytes = read_all(input);
  const DracoMesh source(bytes, input.name(), "");
  const auto position = source.find(DracoMesh::Kind::position);
  if (!position || position->components != 3)
    throw InputError(describe(input.name(), "", "has no positions of three coordinates", "give a mesh of triangles"));

  // The values of the position attribute are the vertices; points are finer.
  RawMesh mesh;
  mesh.positions = source.distinct_values(*position);
  mesh.triangles = source.triangles();
  const std::vector<std::uint32_t> vertex_of = source.value_of_points(*position);
  std::vector<Triangle> points;
  if (config.attributes) points = mesh.triangles;
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& id : t.v) id = vertex_of[id];
  if (config.attributes) mesh.wedges = read_wedges(source, std::move(points));
  return mesh;
}

}  // namespace lodestone
