// What is wrong with a setting, known before it is run: the checks of an experiment's check().
#pragma once

#include <string>
#include <vector>

#include "experiments/studies/experiment.h"

namespace lodestone {

// Collects in words what contradicts itself or has no effect.
class SettingVerdict {
 public:
  // `names`: the parameters that are at odds.
  void require(bool holds, std::vector<std::string> names, const std::string& otherwise);
  // `beside`: what leaves the parameter without effect, as "kappa0 = 2".
  void idle(bool without_effect, const std::string& name, const std::string& beside);

  [[nodiscard]] std::vector<SettingFault> faults() && { return std::move(faults_); }

 private:
  std::vector<SettingFault> faults_;
};

// "kappa0 = 2": a parameter and its value.
[[nodiscard]] std::string assignment(const Parameters& parameters, const std::string& name);

}  // namespace lodestone
