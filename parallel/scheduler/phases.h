// Work in many short phases: items of a phase side by side, each phase after the one before.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Calls body for the items 0 to ends.back() - 1; those of phase p are [ends[p - 1], ends[p]). All workers go through
// the phases together within one loop of the scheduler, and wait actively for the last item of a phase: a worker that
// is put to sleep and woken for each would lose milliseconds on a busy machine. Any number of workers makes progress,
// one alone included. The first exception ends all work and is rethrown.
void run_phases(Scheduler& scheduler, std::span<const std::size_t> ends, const std::function<void(std::size_t)>& body);

}  // namespace lodestone
