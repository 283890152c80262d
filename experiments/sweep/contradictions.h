// Settings that an experiment refuses, and parameters that are given for nothing.
#pragma once

#include <vector>

#include "core/files/json.h"
#include "experiments/studies/experiment.h"
#include "experiments/sweep/design.h"

namespace lodestone {

// `settings` as settings_of() makes them of the design. Throws InputError through `table`, with the line of a parameter
// that is at odds with another one. A parameter without effect is refused where no setting that gives it has a use for
// it, and where it makes several settings of one; in a grid it may be there for the sake of other settings.
// O(settings log settings).
void refuse_contradictions(const Design& design, const std::vector<Json>& settings, const Experiment& experiment,
                           const TomlTable& table);

}  // namespace lodestone
