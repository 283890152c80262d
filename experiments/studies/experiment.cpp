#include "experiments/studies/experiment.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/base/registry.h"

namespace lodestone {

namespace {

Registry<Experiment>& experiments() {
  static Registry<Experiment> all = [] {
    Registry<Experiment> ours("experiment");
    for (const auto& make : {build_experiment, distributed_experiment, effects_experiment, families_experiment,
                             flight_experiment, probe_experiment, progressive_experiment, ranks_experiment,
                             raster_experiment, reconstruct_experiment, scaling_experiment, schedule_experiment,
                             shells_experiment, spherical_experiment, systems_experiment, table_experiment}) {
      Experiment experiment = make();
      const std::string name = experiment.name;
      ours.add(name, std::move(experiment));
    }
    return ours;
  }();
  return all;
}

}  // namespace

void add_experiment(Experiment experiment) {
  if (!experiment.run || !experiment.verify || experiment.columns.empty())
    throw InputError("experiment '" + experiment.name + "' needs run, verify and columns");
  const std::string name = experiment.name;
  experiments().add(name, std::move(experiment));
}

std::vector<std::string> experiment_names() {
  std::vector<std::string> names = experiments().names();
  std::ranges::sort(names);
  return names;
}

const Experiment& find_experiment(const std::string& name) { return experiments().at(name); }

}  // namespace lodestone
