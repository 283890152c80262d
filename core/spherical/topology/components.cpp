#include "core/spherical/topology/components.h"

#include <cstddef>
#include <utility>

#include "core/base/disjoint_sets.h"
#include "core/spherical/topology/sides.h"

namespace lodestone::spherical {

std::vector<Surface> split_components(Surface surface) {
  DisjointSets sets(surface.positions.size());
  for (const auto& [v] : surface.triangles) {
    sets.unite(v[0], v[1]);
    sets.unite(v[1], v[2]);
  }
  // By the vertex that stands for a component.
  struct Size {
    Id name = no_id, vertices = 0, triangles = 0;
  };
  std::vector<Size> sizes(surface.positions.size());
  std::vector<Surface> parts;
  for (const auto& [v] : surface.triangles) {
    Size& size = sizes[sets.find(v[0])];
    ++size.triangles;
    if (size.name != no_id) continue;
    size.name = static_cast<Id>(parts.size());
    parts.emplace_back();
  }
  if (parts.size() == 1) {
    parts[0] = std::move(surface);
    return parts;
  }
  std::vector<Id> renamed(surface.positions.size());
  for (Id v = 0; v < renamed.size(); ++v) ++sizes[sets.find(v)].vertices;
  for (const Size& size : sizes) {
    if (size.name == no_id) continue;
    parts[size.name].positions.reserve(size.vertices);
    parts[size.name].source_vertex.reserve(size.vertices);
    parts[size.name].triangles.reserve(size.triangles);
    parts[size.name].source_triangle.reserve(size.triangles);
  }
  for (Id v = 0; v < renamed.size(); ++v) {
    Surface& part = parts[sizes[sets.find(v)].name];
    renamed[v] = static_cast<Id>(part.positions.size());
    part.positions.push_back(surface.positions[v]);
    part.source_vertex.push_back(surface.source_vertex[v]);
  }
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& v = surface.triangles[t].v;
    Surface& part = parts[sizes[sets.find(v[0])].name];
    part.triangles.push_back({{renamed[v[0]], renamed[v[1]], renamed[v[2]]}});
    part.source_triangle.push_back(surface.source_triangle[t]);
  }
  return parts;
}

}  // namespace lodestone::spherical
