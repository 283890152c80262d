// Simplifiers of other libraries that bench_simplify runs beside the project's own.
#pragma once

#include "core/simplify/peers/whole_mesh.h"

namespace lodestone::bench {

#ifdef LODESTONE_HAS_CGAL
// Lindstrom and Turk's cost and placement: memoryless, with volumes and boundaries kept (lindstrom1998). Keeps the
// whole border. The mesh has to be manifold.
[[nodiscard]] PeerMesh simplify_with_cgal(const PeerMesh& mesh, std::size_t triangles);
#endif

}  // namespace lodestone::bench
