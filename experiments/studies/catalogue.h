// The experiments that there are, a file each; experiments() lists them.
#pragma once

#include "experiments/studies/experiment.h"

namespace lodestone {

[[nodiscard]] Experiment build_experiment();
[[nodiscard]] Experiment effects_experiment();
[[nodiscard]] Experiment families_experiment();
[[nodiscard]] Experiment flight_experiment();
[[nodiscard]] Experiment progressive_experiment();
[[nodiscard]] Experiment raster_experiment();
[[nodiscard]] Experiment reconstruct_experiment();
[[nodiscard]] Experiment scaling_experiment();
[[nodiscard]] Experiment systems_experiment();
[[nodiscard]] Experiment table_experiment();

}  // namespace lodestone
