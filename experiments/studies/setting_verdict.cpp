#include "experiments/studies/setting_verdict.h"

#include <utility>

namespace lodestone {

void SettingVerdict::require(bool holds, std::vector<std::string> names, const std::string& otherwise) {
  if (!holds) faults_.push_back({std::move(names), otherwise, false});
}

void SettingVerdict::idle(bool without_effect, const std::string& name, const std::string& beside) {
  if (without_effect) faults_.push_back({{name}, name + " has no effect beside " + beside, true});
}

std::string assignment(const Parameters& parameters, const std::string& name) {
  return name + " = " + parameters.json().at(name).dump();
}

}  // namespace lodestone
