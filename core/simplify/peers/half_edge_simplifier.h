// OpenMesh's decimater behind the simplifiers' contract: the reference from outside, slow.
#pragma once

#include <memory>

#include "core/simplify/block/simplifier.h"

namespace lodestone {

// Collapses in the order of an exact heap over OpenMesh's quadrics (ModQuadricT); survivors stay where they are.
[[nodiscard]] std::unique_ptr<Simplifier> make_openmesh_simplifier();

}  // namespace lodestone
