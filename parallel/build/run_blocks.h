// The three orders in which the blocks of a hierarchy may run.
#pragma once

#include <cstdint>
#include <functional>

#include "core/hierarchy/build/cell_table.h"
#include "parallel/build/build.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Calls run(block) for every block of the plan, after all that it depends on, from several workers at once unless the
// strategy is serial. Throws Cancelled when `cancel` is set.
void run_blocks(const BlockPlan& plan, Strategy strategy, Scheduler& scheduler, const CancelFlag* cancel,
                const std::function<void(std::uint32_t)>& run);

}  // namespace lodestone
