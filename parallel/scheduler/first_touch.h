// Fresh memory, touched by all workers.
#pragma once

#include <cstddef>
#include <vector>

#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Gives an empty vector `size` value-initialised elements. Most of that cost are the page faults of memory used for the
// first time: they are taken in parallel, before the elements are made. (Huge pages were tried instead: three times
// faster where the system has them at hand, three times slower where it has to make them.)
template <class T>
void resize_in_parallel(std::vector<T>& vector, std::size_t size, Scheduler& scheduler) {
  constexpr std::size_t page = 4096, grain = std::size_t{1} << 22;
  vector.reserve(size);
  const auto bytes = reinterpret_cast<volatile char*>(vector.data());
  scheduler.for_chunks(size * sizeof(T), grain, [&](ChunkRange range) {
    for (std::size_t at = range.begin; at < range.end; at += page) bytes[at] = 0;
  });
  vector.resize(size);
}

}  // namespace lodestone
