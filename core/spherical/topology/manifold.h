// An oriented manifold, with borders, of any triangles: what does not fit together is cut apart (gueziec2001).
#pragma once

#include <cstdint>

#include "core/mesh/indexed_mesh.h"
#include "core/spherical/surface.h"
#include "core/spherical/topology/report.h"

namespace lodestone::spherical {

// Counts of what was changed; all zero for a mesh that was an oriented manifold.

struct Manifold {
  Surface surface;  // all components
  ManifoldRepairs repairs;
};

// Wedges of a position are one vertex. Every edge of the result has one triangle, or two with opposite directions; no
// two edges have the same ends; every vertex has a single fan; no two triangles share all sides. Nearly linear; some 60
// bytes per triangle besides the result. Throws ResourceError beyond 1.4 billion triangles.
[[nodiscard]] Manifold make_manifold(const IndexedMesh& mesh);

}  // namespace lodestone::spherical
