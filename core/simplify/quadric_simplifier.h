// The project's own simplifier: quadric half-edge collapse in cache, about 10 million triangles per core-second.
#pragma once

#include <memory>

#include "core/simplify/simplifier.h"

namespace lodestone {

enum class InstructionSet { best, plain, avx2 };

// Whether this machine can run it; `best` and `plain` always.
[[nodiscard]] bool is_available(InstructionSet set);

// Every set gives the same bytes. Working memory: about 180 bytes per vertex of the largest block so far, at most 12
// MB. Throws UnsupportedError where the set is not available.
[[nodiscard]] std::unique_ptr<Simplifier> make_quadric_simplifier(InstructionSet set = InstructionSet::best,
                                                                  Placement placement = Placement::optimal);

}  // namespace lodestone
