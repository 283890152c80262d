// Gain by more threads: speed-up, efficiency, and the serial share that explains them (karp1990).
#pragma once

#include <span>
#include <vector>

namespace lodestone {

struct ThreadTime {
  int threads = 1;     // at least 1
  double seconds = 0;  // wall, positive
  double work = 1;     // how much was done, in any unit, positive; the same for all: strong scaling
};

struct Scaling {
  int threads = 1;
  double seconds = 0;
  double speedup = 1;     // work per second over that of one thread
  double efficiency = 1;  // speedup / threads
  // Experimentally determined serial fraction, (1 / speedup - 1 / threads) / (1 - 1 / threads), of equal work; negative
  // for more than linear speed-up; 0 for one thread and where the work differs from that of one thread.
  double karp_flatt = 0;
};

// One row for each, in the order given. For weak scaling `work` grows with the threads, and speedup is the scaled one.
// Throws InputError without exactly one row of one thread, for a number of threads that comes twice, and for numbers
// out of range.
[[nodiscard]] std::vector<Scaling> scaling(std::span<const ThreadTime> times);

}  // namespace lodestone
