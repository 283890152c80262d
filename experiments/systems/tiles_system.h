// 3D Tiles as a system of levels of detail: tiles replace their parent by its error on the screen.
#pragma once

#include "experiments/systems/lod_system.h"

namespace lodestone {

[[nodiscard]] LodSystem tiles_system(bool skirts);

}  // namespace lodestone
