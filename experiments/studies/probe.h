// The experiment `probe`: known results, and every way to fail, for trying out a machine, a cluster or the sweep
// itself.
#pragma once

#include "experiments/studies/experiment.h"

namespace lodestone {
[[nodiscard]] Experiment probe_experiment();
}  // namespace lodestone
