// Rings of generated surfaces, for tests of the map to the sphere.
#pragma once

#include <algorithm>
#include <vector>

#include "core/progressive/collapse/ring_mesh.h"
#include "tests/test_meshes.h"

namespace lodestone::test {

struct RingSurface {
  explicit RingSurface(IndexedMesh of) : mesh(std::move(of)), rings(mesh) {
    rings.list_corners();
    rings.make_rings(0, mesh.positions.size(), arena);
    rings.cut_open();
  }

  IndexedMesh mesh;
  progressive::RingArena arena;
  progressive::RingMesh rings;
};

// The neighbours of every vertex in order, the least first; empty where there is no vertex.
inline std::vector<std::vector<progressive::Id>> neighbours_of(const progressive::RingMesh& rings) {
  std::vector<std::vector<progressive::Id>> out;
  for (progressive::Id v = 0; v < rings.vertex_count(); ++v) {
    std::vector<progressive::Id>& ring = out.emplace_back();
    if (!rings.is_used(v)) continue;
    ring.assign(rings.ring(v).ids, rings.ring(v).ids + rings.ring(v).size);
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
  }
  return out;
}

}  // namespace lodestone::test
