// Chooses among the simplifiers.
#pragma once

#include <memory>

#include "core/simplify/contract/simplifier.h"

namespace lodestone {

// Throws InputError if the kind does not support the placement.
[[nodiscard]] std::unique_ptr<Simplifier> make_simplifier(SimplifierKind kind, Placement placement);
[[nodiscard]] inline std::unique_ptr<Simplifier> make_simplifier(SimplifierKind kind) {
  return make_simplifier(kind, default_placement(kind));
}

}  // namespace lodestone
