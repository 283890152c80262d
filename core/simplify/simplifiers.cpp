#include "core/simplify/simplifiers.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/base/registry.h"
#include "core/simplify/contract/checked_simplifier.h"
#include "core/simplify/peers/peers.h"
#include "core/simplify/quadric/quadric_simplifier.h"

namespace lodestone {
namespace {

Registry<SimplifierInfo>& simplifiers() {
  static Registry<SimplifierInfo> all = [] {
    Registry<SimplifierInfo> ours("simplifier");
    ours.add("quadric", {[](Placement placement) { return make_quadric_simplifier(InstructionSet::best, placement); },
                         {Placement::optimal, Placement::endpoint}});
    ours.add("cluster", {[](Placement) { return make_cluster_simplifier(); }});
    ours.add("openmesh", {[](Placement) { return make_openmesh_simplifier(); }});
    ours.add("meshopt", {[](Placement) { return make_meshopt_simplifier(); }});
    return ours;
  }();
  return all;
}

bool knows(const SimplifierInfo& info, Placement placement) {
  return std::ranges::find(info.placements, placement) != info.placements.end();
}

}  // namespace

void add_simplifier(const std::string& name, SimplifierInfo info) {
  if (!info.make || info.placements.empty())
    throw InputError("simplifier '" + name + "': has no function that makes it, or no placement");
  info.make = [name, make = std::move(info.make)](Placement placement) {
    return make_checked_simplifier(name, make(placement));
  };
  simplifiers().add(name, std::move(info));
}

std::vector<std::string> simplifier_names() { return simplifiers().names(); }

std::string simplifiers_that_know(Placement placement) {
  std::string names;
  for (const std::string& name : simplifier_names())
    if (knows(simplifiers().at(name), placement)) names += (names.empty() ? "" : ", ") + name;
  return names;
}

const std::vector<Placement>& placements_of(std::string_view simplifier) {
  return simplifiers().at(simplifier).placements;
}

std::unique_ptr<Simplifier> make_simplifier(std::string_view name, Placement placement) {
  const SimplifierInfo& info = simplifiers().at(name);
  if (knows(info, placement)) return info.make(placement);
  throw InputError(describe(
      "", "",
      "simplifier '" + std::string(name) + "' does not know the placement '" + std::string(name_of(placement)) + "'",
      "use the placement '" + std::string(name_of(info.placements.front())) + "', or one of the simplifiers " +
          simplifiers_that_know(placement)));
}

}  // namespace lodestone
