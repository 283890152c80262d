// meshoptimizer behind the simplifiers' contract: the peer.
#pragma once

#include <memory>

#include "core/simplify/block/simplifier.h"

namespace lodestone {

// Where the contract allows all that meshopt_simplify did, the new triangles are exactly its own; survivors stay where
// they are.
[[nodiscard]] std::unique_ptr<Simplifier> make_meshopt_simplifier();

}  // namespace lodestone
