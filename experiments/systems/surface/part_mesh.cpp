#include "experiments/systems/surface/part_mesh.h"

#include <algorithm>

#include "core/base/sort_unique.h"

namespace lodestone {

PartMesh part_mesh(std::span<const Triangle> triangles, std::span<const Vec3f> surface) {
  PartMesh mesh;
  mesh.vertices.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) mesh.vertices.insert(mesh.vertices.end(), t.v.begin(), t.v.end());
  sort_unique(mesh.vertices);
  for (const std::uint32_t v : mesh.vertices) mesh.positions.push_back(surface[v]);
  const auto place = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(mesh.vertices, v) - mesh.vertices.begin());
  };
  for (const Triangle& t : triangles) mesh.triangles.push_back({{place(t.v[0]), place(t.v[1]), place(t.v[2])}});
  return mesh;
}

}  // namespace lodestone
