// Named parts of which a program may have more than ours: simplifiers, backends, experiments.
#pragma once

#include <algorithm>
#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/known_names.h"

namespace lodestone {

// 1 to 64 of a-z, 0-9, '-' and '_'.
[[nodiscard]] inline bool can_be_name(std::string_view name) {
  const auto fits = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_'; };
  return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, fits);
}

// Parts keep their address. They are added before any is used; then any number of threads may look them up.
template <class Part>
class Registry {
 public:
  // `what` is what a message calls a part: "simplifier".
  explicit Registry(std::string what) : what_(std::move(what)) {}

  // Throws InputError for a name that is taken, or that can_be_name refuses.
  void add(const std::string& name, Part part) {
    if (!can_be_name(name))
      throw InputError("'" + name + "' cannot be the name of a " + what_ + "; use up to 64 of a-z, 0-9, '-' and '_'");
    if (find(name)) throw InputError("there is a " + what_ + " '" + name + "' already; choose another name");
    parts_.emplace_back(name, std::move(part));
  }

  // Null for an unknown name.
  [[nodiscard]] const Part* find(std::string_view name) const {
    const auto found = std::ranges::find_if(parts_, [&](const auto& entry) { return entry.first == name; });
    return found == parts_.end() ? nullptr : &found->second;
  }

  // Throws InputError that lists the known names.
  [[nodiscard]] const Part& at(std::string_view name) const {
    if (const Part* part = find(name)) return *part;
    throw InputError("unknown " + what_ + " '" + std::string(name) + "'; " + known_names(name, names()));
  }

  // In the order in which they were added.
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& [name, part] : parts_) all.push_back(name);
    return all;
  }

 private:
  std::string what_;
  std::deque<std::pair<std::string, Part>> parts_;
};

}  // namespace lodestone
