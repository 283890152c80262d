// Stands in for tbb_scheduler.cpp in builds without oneTBB.
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

std::unique_ptr<Scheduler> make_tbb_scheduler(int) { return make_serial_scheduler(); }

}  // namespace lodestone
