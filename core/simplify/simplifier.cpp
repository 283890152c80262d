#include "core/simplify/simplifier.h"

#include <array>
#include <string>

#include "core/base/error.h"
#include "core/simplify/cluster.h"
#include "core/simplify/quadric_simplifier.h"

namespace lodestone {
namespace {

constexpr std::array<std::string_view, 2> names{"quadric", "cluster"};  // by SimplifierKind

}  // namespace

SimplifierKind simplifier_kind(std::string_view name) {
  for (std::uint32_t k = 0; k < names.size(); ++k)
    if (name == names[k]) return static_cast<SimplifierKind>(k);
  std::string known;
  for (const std::string_view n : names) known += (known.empty() ? "" : ", ") + std::string(n);
  throw InputError(describe("", "", "unknown simplifier '" + std::string(name) + "'", "known are " + known));
}

std::string_view name_of(SimplifierKind kind) { return names.at(static_cast<std::size_t>(kind)); }

std::unique_ptr<Simplifier> make_simplifier(SimplifierKind kind) {
  return kind == SimplifierKind::cluster ? make_cluster_simplifier() : make_quadric_simplifier();
}

}  // namespace lodestone
