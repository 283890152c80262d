// Items that core hands out, on the workers of a scheduler.
#pragma once

#include "core/base/runner.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// The scheduler must outlive it.
[[nodiscard]] inline Runner runner_over(Scheduler& scheduler) {
  Runner runner;
  runner.workers = static_cast<std::size_t>(scheduler.workers());
  runner.run = [&scheduler](std::size_t count, const Runner::Body& body) {
    scheduler.for_chunks(
        count, 1, [&](ChunkRange range) { body(range.begin, static_cast<std::size_t>(scheduler.worker_index())); });
  };
  return runner;
}

}  // namespace lodestone
