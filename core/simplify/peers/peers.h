// Other simplifiers behind the same contract (simplifier.h). Their survivors keep their positions.
#pragma once

#include <memory>

#include "core/simplify/contract/simplifier.h"

namespace lodestone {

// Vertex clustering, the fast and coarse end: a uniform grid inside the block; all vertices of a cell move to the one
// with the least quadric error. Members farther than the bound from it, and locked ones, keep themselves. The cell size
// is searched so that the target is approached; cells are at most as large as the bound can use. May pinch the surface;
// never opens it.
[[nodiscard]] std::unique_ptr<Simplifier> make_cluster_simplifier();

// OpenMesh's decimater, the independent reference: collapses in the order of an exact heap over its quadrics
// (ModQuadricT). Slow.
[[nodiscard]] std::unique_ptr<Simplifier> make_openmesh_simplifier();

// meshoptimizer. Where the contract allows all that meshopt_simplify did, the new triangles are exactly its own.
[[nodiscard]] std::unique_ptr<Simplifier> make_meshopt_simplifier();

}  // namespace lodestone
