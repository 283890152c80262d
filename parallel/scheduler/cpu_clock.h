// Wall and processor time since construction.
#pragma once

#include <chrono>

#include "parallel/scheduler/stage_time.h"

namespace lodestone {

class CpuClock {
 public:
  CpuClock();
  [[nodiscard]] StageTime elapsed() const;  // user + system seconds of the whole process beside wall seconds

 private:
  std::chrono::steady_clock::time_point wall_;
  double cpu_;
};

}  // namespace lodestone
