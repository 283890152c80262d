// What a stage of work took.
#pragma once

namespace lodestone {

struct StageTime {
  double seconds = 0;      // wall
  double cpu_seconds = 0;  // user + system, all threads of the process
};

}  // namespace lodestone
