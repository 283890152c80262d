// Hierarchies for tests, made in the most obvious way and open to being broken by hand.
#pragma once

#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone::test {

struct TinyCell {
  std::vector<Vec3f> positions;
  std::vector<PackedNormal> normals;
  std::vector<std::uint32_t> parents, shared_ids;
  std::vector<Triangle> triangles;
};

// A hierarchy whose payloads are plain vectors: change anything in `tables` or `payloads`, then take hierarchy().
struct TinyHierarchy {
  Hierarchy tables;                // spans unset
  std::vector<TinyCell> payloads;  // one per cell
  // Spans point into a copy of the payloads, which the result keeps alive.
  [[nodiscard]] Hierarchy hierarchy() const;
};

// An octahedron, subdivided `times` times and pushed onto a sphere with two bumps, inside the unit cube: 8 * 4^times
// triangles. `open` leaves out the triangles of one octant.
[[nodiscard]] IndexedMesh bumpy_sphere(int times, bool open = false);

// P is clustering on a lattice fine enough for (1): every vertex goes to the lowest id in its cluster. Everything else
// follows the definitions with maps and sets.
[[nodiscard]] TinyHierarchy tiny_hierarchy(const IndexedMesh& mesh, int finest, float sigma0);

}  // namespace lodestone::test
