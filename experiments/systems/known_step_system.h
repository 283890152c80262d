// A system that pops on purpose, by as much as is asked for: what measures of pops say of a step of known size.
#pragma once

#include "experiments/systems/lod_system.h"

namespace lodestone {

// Draws the finest level, in about half of the frames moved to the side by the tolerance at the point of its box that
// is nearest to the viewer. Which frames these are is a function of the viewpoint that looks random.
[[nodiscard]] LodSystem known_step_system();

}  // namespace lodestone
