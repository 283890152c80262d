#include "parallel/scheduler/cpu_clock.h"

#include <sys/resource.h>

namespace lodestone {
namespace {

double process_cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

CpuClock::CpuClock() : wall_(std::chrono::steady_clock::now()), cpu_(process_cpu_seconds()) {}

StageTime CpuClock::elapsed() const {
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - wall_;
  return {wall.count(), process_cpu_seconds() - cpu_};
}

}  // namespace lodestone
