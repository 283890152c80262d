// The time of recorded work on any number of workers, by list scheduling (graham1969).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "experiments/metrics/schedule/recorded_work.h"

namespace lodestone {

struct VirtualWorkers {
  int count = 1;        // at least 1
  double slowdown = 1;  // of work beside which other workers may be busy, for what they share: memory, caches, clock
};

struct Schedule {
  double seconds = 0;  // wall
  // Seconds of workers without work, while the whole program did what is named (name_of_step(), or the first task of a
  // call), most first.
  std::vector<std::pair<std::string, double>> idle;
};

// A worker that has nothing to do takes the first task that is ready, of the call that began first; one that waits for
// a call of its own takes tasks of that call alone, as the schedulers do. Tasks are ready in the order of the record.
// O(n log n) in the tasks. Throws InputError without a worker or for a slowdown below 1.
[[nodiscard]] Schedule list_schedule(const RecordedWork& work, const VirtualWorkers& workers);

}  // namespace lodestone
