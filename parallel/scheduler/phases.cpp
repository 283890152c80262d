#include "parallel/scheduler/phases.h"

#include <algorithm>
#include <atomic>
#include <thread>

namespace lodestone {
namespace {

// Looks at the counter until it has reached `least`; false if the work has failed meanwhile.
bool wait_for(const std::atomic<std::size_t>& counter, std::size_t least, const std::atomic<bool>& failed) {
  constexpr int looks = 20'000;  // some tens of microseconds: then others may have the processor
  for (int k = 0; counter.load(std::memory_order_acquire) < least; ++k) {
    if (failed.load(std::memory_order_relaxed)) return false;
    if (k >= looks) std::this_thread::yield();
  }
  return true;
}

}  // namespace

// Items are handed out in order, so that an item that is waited for is one that a running worker has.
void run_phases(Scheduler& scheduler, std::span<const std::size_t> ends, const std::function<void(std::size_t)>& body) {
  if (ends.empty()) return;
  std::atomic<std::size_t> next{0}, done{0};
  std::atomic<bool> failed{false};
  // More workers than processors would wait for those that have none.
  const std::size_t processors = std::max(std::thread::hardware_concurrency(), 1u);
  scheduler.for_chunks(std::min(static_cast<std::size_t>(scheduler.workers()), processors), 1, [&](ChunkRange) {
    std::size_t phase = 0;
    for (std::size_t item = next++; item < ends.back(); item = next++) {
      while (item >= ends[phase]) ++phase;
      if (phase > 0 && !wait_for(done, ends[phase - 1], failed)) return;
      try {
        body(item);
      } catch (...) {
        failed = true;
        throw;
      }
      done.fetch_add(1, std::memory_order_release);
    }
  });
}

}  // namespace lodestone
