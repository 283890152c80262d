// The collapse kernel for any processor.
#include "core/progressive/collapse/collapse_lanes.h"
#include "core/progressive/collapse/id_lanes_plain.h"
#include "core/progressive/collapse/kernel_table.h"

namespace lodestone::progressive {

const CollapseKernel plain_collapse_kernel = kernel_of<plain::Lanes>();

}  // namespace lodestone::progressive
