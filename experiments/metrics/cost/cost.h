// Time and memory that a phase of work takes.
#pragma once

#include <cstdint>
#include <string>

#include "parallel/scheduler/clock.h"

namespace lodestone {

struct Cost {
  double seconds = 0;      // wall
  double cpu_seconds = 0;  // user + system, all threads of the process
  // Largest resident set of the process, bytes; that of the phase alone when peak_of_phase, otherwise of the whole
  // process up to its end.
  std::uint64_t peak_memory = 0;
  bool peak_of_phase = false;
  // Sizes of input and output, filled in by the caller; 0: not given.
  std::uint64_t bytes = 0, triangles = 0, vertices = 0, cells = 0, draw_calls = 0;
};

// Largest resident set of the process since it began or since the last reset, bytes (VmHWM of /proc/self/status; where
// there is none, that of getrusage).
[[nodiscard]] std::uint64_t peak_resident_bytes();
// Sets it back to what is resident now (5 into /proc/self/clear_refs). False where the system does not permit that.
bool reset_peak_resident();

// Measures from its construction. One at a time: the peak is that of the process, and a second one would reset it.
class CostMeter {
 public:
  CostMeter() : reset_(reset_peak_resident()) {}
  // Time and memory since construction.
  [[nodiscard]] Cost elapsed() const;

 private:
  bool reset_;
  CpuClock clock_;
};

}  // namespace lodestone
