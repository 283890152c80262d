// The slow, obvious twin of the quadric kernel: half-edge collapse with an exact heap, everything in double.
#pragma once

#include <memory>

#include "core/simplify/contract/simplifier.h"

namespace lodestone {

// Keeps every guarantee of simplifier.h; about a hundred times slower than the kernel it is compared with.
[[nodiscard]] std::unique_ptr<Simplifier> make_quadric_reference();

}  // namespace lodestone
