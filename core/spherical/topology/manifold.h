// An oriented manifold, with borders, of any triangles: what does not fit together is cut apart (gueziec2001).
#pragma once

#include <cstdint>

#include "core/mesh/indexed_mesh.h"
#include "core/spherical/surface.h"

namespace lodestone::spherical {

// Counts of what was changed; all zero for a mesh that was an oriented manifold.
struct ManifoldRepairs {
  std::uint64_t turned_triangles = 0;   // to agree with their neighbours: the fewer of each patch
  std::uint64_t nonmanifold_edges = 0;  // of three triangles or more: cut, with triangles paired by angle
  std::uint64_t clashing_edges = 0;     // cut where a patch has only one side, as a Moebius strip
  std::uint64_t pinched_vertices = 0;   // of the input, which have several fans of triangles
  std::uint64_t vertex_copies = 0;      // that those got: one for each further fan
  std::uint64_t split_edges = 0;        // halved, as others had the same two ends after the cuts
  friend bool operator==(const ManifoldRepairs&, const ManifoldRepairs&) = default;
};

struct Manifold {
  Surface surface;  // all components
  ManifoldRepairs repairs;
};

// Wedges of a position are one vertex. Every edge of the result has one triangle, or two with opposite directions; no
// two edges have the same ends; every vertex has a single fan; no two triangles share all sides. Nearly linear; some 60
// bytes per triangle besides the result. Throws ResourceError beyond 1.4 billion triangles.
[[nodiscard]] Manifold make_manifold(const IndexedMesh& mesh);

}  // namespace lodestone::spherical
