// Wall time of the stages of a frame.
#pragma once

#include <chrono>
#include <utility>

namespace lodestone {

class Stopwatch {
 public:
  // Since construction or the last lap.
  [[nodiscard]] double milliseconds() const { return between(start_, Clock::now()); }
  double lap() {
    const Clock::time_point now = Clock::now();
    return between(std::exchange(start_, now), now);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
  }
  Clock::time_point start_ = Clock::now();
};

}  // namespace lodestone
