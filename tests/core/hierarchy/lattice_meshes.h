// Meshes and hierarchies, also on a lattice, for tests of the hierarchy.
#pragma once

#include <cmath>

#include "core/mesh/clean.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone::test {

// An octahedron, subdivided `times` times and pushed onto a sphere with two bumps, inside the unit cube: 8 * 4^times
// triangles. `open` leaves out the triangles of one octant.
[[nodiscard]] inline IndexedMesh bumpy_sphere(int times, bool open = false) {
  std::vector<Vec3d> points{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  std::vector<Triangle> triangles{{{0, 1, 2}}, {{1, 3, 2}}, {{3, 4, 2}}, {{4, 0, 2}},
                                  {{1, 0, 5}}, {{3, 1, 5}}, {{4, 3, 5}}, {{0, 4, 5}}};
  if (open) triangles.pop_back();
  subdivide_on_sphere(points, triangles, times);
  IndexedMesh mesh;
  mesh.transform = {{10, 20, 30}, 4};
  mesh.triangles = triangles;
  for (const Vec3d p : points) {
    const double radius = 0.4 + 0.05 * std::sin(5 * p.x) * std::cos(4 * p.y) + 0.02 * std::sin(9 * p.z + 1);
    mesh.positions.push_back(to_float(Vec3d{0.5, 0.5, 0.5} + radius * p));
  }
  return mesh;
}

// The mesh, cleaned anew on the lattice.
[[nodiscard]] inline IndexedMesh on_lattice(const IndexedMesh& mesh, Lattice lattice) {
  Repairs repairs;
  return clean_mesh(raw_of(mesh), repairs, {}, lattice);
}

[[nodiscard]] inline NaiveHierarchy lattice_sphere(int times, Lattice lattice, int finest = 2) {
  return naive_hierarchy(on_lattice(bumpy_sphere(times), lattice), finest, 0.3f);
}

}  // namespace lodestone::test
