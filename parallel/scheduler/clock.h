// The clocks: wall time, and wall with processor time.
#pragma once

#include <chrono>
#include <utility>

namespace lodestone {

// Duration of a stage of work.
struct StageTime {
  double seconds = 0;      // wall
  double cpu_seconds = 0;  // user + system, all threads of the process

  StageTime& operator+=(const StageTime& more) {
    seconds += more.seconds, cpu_seconds += more.cpu_seconds;
    return *this;
  }
};

// Wall time since construction or the last lap.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const { return between(start_, Clock::now()); }
  [[nodiscard]] double milliseconds() const { return 1000 * seconds(); }
  // Starts the next lap; returns the milliseconds of the one that ends.
  double lap() {
    const Clock::time_point now = Clock::now();
    return 1000 * between(std::exchange(start_, now), now);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
  }
  Clock::time_point start_ = Clock::now();
};

// Processor time of the calling thread so far.
[[nodiscard]] double thread_cpu_seconds();

// Wall and processor time since construction.
class CpuClock {
 public:
  [[nodiscard]] StageTime elapsed() const { return {wall_.seconds(), process_cpu_seconds() - cpu_}; }

 private:
  static double process_cpu_seconds();
  Stopwatch wall_;
  double cpu_ = process_cpu_seconds();
};

}  // namespace lodestone
