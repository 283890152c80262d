// The project's own simplifier: quadric half-edge collapse in cache, about 10 million triangles per core-second.
#pragma once

#include <memory>

#include "core/base/instruction_set.h"
#include "core/simplify/contract/simplifier.h"

namespace lodestone {

// Every set gives the same bytes. Working memory: about 180 bytes per vertex of the largest block so far, at most 12
// MB. Throws UnsupportedError if the set is not available.
[[nodiscard]] std::unique_ptr<Simplifier> make_quadric_simplifier(InstructionSet set = InstructionSet::best,
                                                                  Placement placement = Placement::optimal);

}  // namespace lodestone
