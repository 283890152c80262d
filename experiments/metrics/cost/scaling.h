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

// Both ends of what holds 95 % of the speed-ups, or serial shares, that the medians of rounds drawn anew would give:
// the percentile bootstrap (efron1993), of 2,000 draws that are always the same.
struct Interval {
  double low = 0, high = 0;
};
struct ScalingIntervals {
  Interval speedup, karp_flatt;
};

// `one`, `many`: wall seconds of the rounds of one thread and of this number of threads, which did `work` times what
// one did. Throws InputError as scaling() does, and without a round.
[[nodiscard]] ScalingIntervals scaling_intervals(const std::vector<double>& one, const std::vector<double>& many,
                                                 int threads, double work = 1);

}  // namespace lodestone
