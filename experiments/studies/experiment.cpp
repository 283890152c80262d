#include "experiments/studies/experiment.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/known_names.h"

namespace lodestone {

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all = [] {
    std::vector<Experiment> list{
        build_experiment(),   effects_experiment(), families_experiment(),    flight_experiment(),
        probe_experiment(),   raster_experiment(),  progressive_experiment(), reconstruct_experiment(),
        scaling_experiment(), shells_experiment(),  spherical_experiment(),   systems_experiment(),
        table_experiment(),
    };
    std::sort(list.begin(), list.end(), [](const Experiment& a, const Experiment& b) { return a.name < b.name; });
    return list;
  }();
  return all;
}

const Experiment& find_experiment(const std::string& name) {
  std::vector<std::string> known;
  for (const Experiment& experiment : experiments()) {
    if (experiment.name == name) return experiment;
    known.push_back(experiment.name);
  }
  throw InputError("unknown experiment '" + name + "'; " + known_names(name, known));
}

}  // namespace lodestone
