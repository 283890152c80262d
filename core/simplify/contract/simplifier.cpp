#include "core/simplify/contract/simplifier.h"

#include <array>
#include <string>

#include "core/base/error.h"
#include "core/base/known_names.h"

namespace lodestone {
namespace {

// By SimplifierKind, and by Placement.
constexpr std::array<std::string_view, all_simplifier_kinds.size()> names{"quadric", "cluster", "openmesh", "meshopt"};
constexpr std::array<std::string_view, 2> placement_names{"optimal", "endpoint"};

template <std::size_t N>
std::uint32_t index_of(std::string_view name, const std::array<std::string_view, N>& known, const char* what) {
  for (std::uint32_t k = 0; k < N; ++k)
    if (name == known[k]) return k;
  throw InputError(describe("", "", std::string("unknown ") + what + " '" + std::string(name) + "'",
                            known_names(name, {known.begin(), known.end()})));
}

}  // namespace

SimplifierKind simplifier_kind(std::string_view name) {
  return static_cast<SimplifierKind>(index_of(name, names, "simplifier"));
}

std::string_view name_of(SimplifierKind kind) { return names.at(static_cast<std::size_t>(kind)); }

Placement placement(std::string_view name) {
  return static_cast<Placement>(index_of(name, placement_names, "placement"));
}

std::string_view name_of(Placement placement) { return placement_names.at(static_cast<std::size_t>(placement)); }

Placement default_placement(SimplifierKind kind) {
  return kind == SimplifierKind::quadric ? Placement::optimal : Placement::endpoint;
}

}  // namespace lodestone
