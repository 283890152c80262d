// Collapses of regions that ran side by side, brought into one order.
#pragma once

#include <span>
#include <vector>

#include "core/progressive/collapse/collapse_kernel.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// By `order`, of equal ones those of earlier parts first; each part is in order already. Appends to `records`.
void merge_records(std::span<const std::vector<progressive::CollapseRecord>> parts,
                   std::vector<progressive::CollapseRecord>& records, Scheduler& scheduler);

}  // namespace lodestone
