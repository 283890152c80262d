// The simplifiers, by name: ours, and those that a program adds.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/simplify/contract/simplifier.h"

namespace lodestone {

struct SimplifierInfo {
  std::function<std::unique_ptr<Simplifier>(Placement)> make;  // an instance for one thread; called by several
  std::vector<Placement> placements{Placement::endpoint};      // that it knows; the first is the default
};

// Makes a simplifier known as BuildConfig::simplifier and --simplifier; files that it makes have its name. What it
// returns is checked against the guarantees on positions, locks, labels and wedges (SimplifierContract::check). Throws
// InputError for a name that is taken or cannot be one (core/base/registry.h), and for an info without make or
// placements. To be called before any is used.
void add_simplifier(const std::string& name, SimplifierInfo info);

// "quadric", "cluster", "openmesh", "meshopt", and what was added.
[[nodiscard]] std::vector<std::string> simplifier_names();

// Their names, separated by commas; empty if there are none.
[[nodiscard]] std::string simplifiers_that_know(Placement placement);

// Throw InputError for an unknown name, and for a placement that the simplifier does not know.
[[nodiscard]] const std::vector<Placement>& placements_of(std::string_view simplifier);
[[nodiscard]] std::unique_ptr<Simplifier> make_simplifier(std::string_view name, Placement placement);
[[nodiscard]] inline std::unique_ptr<Simplifier> make_simplifier(std::string_view name) {
  return make_simplifier(name, placements_of(name).front());
}

}  // namespace lodestone
