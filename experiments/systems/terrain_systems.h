// Levels of detail of height fields as systems; for models that are grids of heights.
#pragma once

#include "experiments/systems/lod_system.h"

namespace lodestone {

[[nodiscard]] LodSystem chunked_system();
[[nodiscard]] LodSystem clipmap_system();

}  // namespace lodestone
