#include "experiments/metrics/cost/cost.h"

#include <sys/resource.h>

#include <cstdlib>
#include <fstream>

#include "parallel/scheduler/clock.h"

namespace lodestone {

std::uint64_t peak_resident_bytes() {
  // ru_maxrss also holds what the process was before it became this program: a shell, an interpreter.
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::strtoull(line.c_str() + 6, nullptr, 10) * 1024;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

bool reset_peak_resident() {
  std::ofstream clear("/proc/self/clear_refs");
  clear << '5';
  return static_cast<bool>(clear.flush());
}

Cost CostMeter::elapsed() const {
  const StageTime time = clock_.elapsed();
  Cost cost;
  cost.seconds = time.seconds;
  cost.cpu_seconds = time.cpu_seconds;
  cost.peak_memory = peak_resident_bytes();
  cost.peak_of_phase = reset_;
  return cost;
}

}  // namespace lodestone
