// The collapse kernel for any processor.
#include "core/progressive/collapse/collapse_run.h"

namespace lodestone::progressive {

const CollapseKernel* const plain_collapse_kernel = &plain::collapse_functions;

}  // namespace lodestone::progressive
