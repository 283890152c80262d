// Progressive meshes as systems of levels of detail.
#pragma once

#include "experiments/systems/lod_system.h"

namespace lodestone {

// One prefix of the whole model, by the place of the surface that is nearest to the viewer.
[[nodiscard]] LodSystem progressive_whole_system();
// Splits where the viewer sees their errors.
[[nodiscard]] LodSystem vdpm_system();

}  // namespace lodestone
