// Vertex clustering: the fast and coarse end of the simplifiers.
#pragma once

#include <memory>

#include "core/simplify/block/simplifier.h"

namespace lodestone {

// A uniform grid inside the block; all vertices of a cell move to the one with the least quadric error. Members
// farther than the bound from it, and locked ones, keep themselves. The cell size is searched so that the target is
// approached, cells being at most as large as the bound can use. May pinch the surface; never opens it.
[[nodiscard]] std::unique_ptr<Simplifier> make_cluster_simplifier();

}  // namespace lodestone
