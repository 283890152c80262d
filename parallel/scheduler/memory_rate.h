// The rate at which some workers at once get at the memory of this machine.
#pragma once

#include <cstddef>

#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Bytes a second of the triad a = b + s c (mccalpin1995), the best of `rounds`, over three arrays of so many bytes
// each: four times the largest cache, or the figure is one of that cache. Counts 24 bytes for each element.
[[nodiscard]] double memory_rate(std::size_t bytes, int rounds, Scheduler& scheduler);

}  // namespace lodestone
