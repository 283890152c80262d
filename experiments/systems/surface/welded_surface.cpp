#include "experiments/systems/surface/welded_surface.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "core/base/error.h"
#include "core/hierarchy/model/cell_code.h"
#include "core/mesh/edge_pairing.h"

namespace lodestone {
WeldedSurface welded_surface(const Hierarchy& model, std::string_view system) {
  if (model.attributes != AttributeSet{})
    throw InputError("the system " + std::string(system) +
                     " draws positions and normals alone; give it a model without textures, colours and materials");
  WeldedSurface copies;
  for (const Cell& cell : model.cells_of(model.finest())) {
    const auto first = static_cast<std::uint32_t>(copies.positions.size());
    copies.positions.insert(copies.positions.end(), cell.positions.begin(), cell.positions.end());
    copies.normals.insert(copies.normals.end(), cell.normals.begin(), cell.normals.end());
    for (const Triangle& t : cell.triangles)
      copies.triangles.push_back({{first + t.v[0], first + t.v[1], first + t.v[2]}});
  }
  const std::size_t count = copies.positions.size();
  std::vector<unsigned> place(count);
  const std::size_t places =
      meshopt_generateVertexRemap(place.data(), nullptr, count, copies.positions.data(), count, sizeof(Vec3f));
  WeldedSurface surface{std::vector<Vec3f>(places), std::vector<PackedNormal>(places), {}};
  for (std::size_t i = 0; i < count; ++i)
    surface.positions[place[i]] = copies.positions[i], surface.normals[place[i]] = copies.normals[i];
  for (const Triangle& t : copies.triangles) {
    const Triangle own{{place[t.v[0]], place[t.v[1]], place[t.v[2]]}};
    if (!is_degenerate(own)) surface.triangles.push_back(own);
  }
  return surface;
}

IndexedMesh indexed_mesh(const WeldedSurface& surface, const Transform& transform) {
  IndexedMesh mesh;
  mesh.positions = surface.positions, mesh.triangles = surface.triangles, mesh.transform = transform;
  return mesh;
}

std::vector<PackedNormal> normals_at(const WeldedSurface& surface, std::span<const Vec3f> positions) {
  std::vector<std::uint32_t> order(surface.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto place = [&](std::uint32_t v) { return surface.positions[v]; };
  std::ranges::sort(order, is_lower<Vec3f>, place);
  std::vector<PackedNormal> normals(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto at = std::ranges::lower_bound(order, positions[i], is_lower<Vec3f>, place);
    if (at != order.end() && surface.positions[*at] == positions[i]) normals[i] = surface.normals[*at];
  }
  return normals;
}

std::vector<std::uint32_t> coherent_order(std::span<const Vec3f> positions, std::span<const Triangle> triangles) {
  constexpr int bits = 10;
  std::vector<std::uint64_t> code;
  for (const Triangle& t : triangles) code.push_back(CellCode::from(cell_of(positions[t.v[0]], bits)).morton);
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t t) { return code[t]; });
  return order;
}

}  // namespace lodestone
