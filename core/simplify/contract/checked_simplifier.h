// The promises of every simplifier, looked at from outside: for simplifiers that others wrote, and for tests.
#pragma once

#include <memory>
#include <string>

#include "core/simplify/contract/simplifier.h"

namespace lodestone {

// Empty, or the first guarantee that does not hold, with its place: sizes, P in range and idempotent, labels, wedges,
// locked vertices, positions finite and on the lattice, the displacement in double, the number of triangles. Topology
// is not looked at. Linear in vertices and triangles.
[[nodiscard]] std::string broken_contract(const SimplifyInput& input, const SimplifyResult& result);

// Passes everything on, and throws InputError with the name when a result breaks the contract.
[[nodiscard]] std::unique_ptr<Simplifier> make_checked_simplifier(std::string name, std::unique_ptr<Simplifier> inner);

}  // namespace lodestone
