// Meshes and hierarchies on a lattice, for tests of what stands on it.
#pragma once

#include "core/mesh/clean.h"
#include "tests/core/hierarchy/tiny_hierarchy.h"

namespace lodestone::test {

// The bumpy sphere, cleaned anew on the lattice.
[[nodiscard]] inline IndexedMesh on_lattice(const IndexedMesh& mesh, Lattice lattice) {
  RawMesh raw;
  for (const Vec3f p : mesh.positions) raw.positions.push_back(to_double(p));
  raw.triangles = mesh.triangles;
  Repairs repairs;
  return clean_mesh(raw, repairs, {}, lattice);
}

[[nodiscard]] inline TinyHierarchy lattice_sphere(int times, Lattice lattice, int finest = 2) {
  return tiny_hierarchy(on_lattice(bumpy_sphere(times), lattice), finest, 0.3f);
}

}  // namespace lodestone::test
