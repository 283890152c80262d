#include "parallel/scheduler/memory_rate.h"

#include <algorithm>
#include <memory>

#include "parallel/scheduler/clock.h"

namespace lodestone {

double memory_rate(std::size_t bytes, int rounds, Scheduler& scheduler) {
  const std::size_t count = std::max<std::size_t>(bytes / sizeof(double), 1);
  const std::size_t grain = chunk_count(count, static_cast<std::size_t>(scheduler.workers()));
  // Not cleared: the workers that use the arrays touch them first, each its own part.
  const auto a = std::make_unique_for_overwrite<double[]>(count), b = std::make_unique_for_overwrite<double[]>(count),
             c = std::make_unique_for_overwrite<double[]>(count);
  scheduler.for_chunks(count, grain, [&](ChunkRange range) {
    for (std::size_t i = range.begin; i < range.end; ++i) a[i] = 0, b[i] = 1, c[i] = 2;
  });
  double best = 0;
  for (int round = 0; round < rounds; ++round) {
    const Stopwatch clock;
    scheduler.for_chunks(count, grain, [&](ChunkRange range) {
      double* const to = a.get();
      const double *const x = b.get(), *const y = c.get();
      for (std::size_t i = range.begin; i < range.end; ++i) to[i] = x[i] + 3 * y[i];
    });
    best = std::max(best, 24.0 * static_cast<double>(count) / clock.seconds());
  }
  return best;
}

}  // namespace lodestone
