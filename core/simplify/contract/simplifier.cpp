#include "core/simplify/contract/simplifier.h"

#include <array>
#include <string>

#include "core/base/error.h"
#include "core/base/known_names.h"

namespace lodestone {
namespace {

constexpr std::array<std::string_view, 2> names{"optimal", "endpoint"};

}  // namespace

Placement placement_named(std::string_view name) {
  for (std::uint32_t k = 0; k < names.size(); ++k)
    if (name == names[k]) return static_cast<Placement>(k);
  throw InputError(describe("", "", "unknown placement '" + std::string(name) + "'",
                            known_names(name, {names.begin(), names.end()})));
}

std::string_view name_of(Placement placement) { return names.at(static_cast<std::size_t>(placement)); }

}  // namespace lodestone
