// A scheduler that stops soon after a flag is set, whatever it is used for.
#pragma once

#include <memory>

#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Behaves as `inner` does, but looks at the flag before each chunk and task, and throws Cancelled when it is set.
// `cancel` may be nullptr: never.
[[nodiscard]] std::unique_ptr<Scheduler> make_cancelling_scheduler(Scheduler& inner, const CancelFlag* cancel);

}  // namespace lodestone
