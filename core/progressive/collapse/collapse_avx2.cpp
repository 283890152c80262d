// The collapse kernel for processors with AVX2. Only this file is compiled for them.
#include "core/progressive/collapse/collapse_run.h"

namespace lodestone::progressive {

#if defined(__AVX2__)
const CollapseKernel* const avx2_collapse_kernel = &avx2::collapse_functions;
#else
const CollapseKernel* const avx2_collapse_kernel = nullptr;
#endif

}  // namespace lodestone::progressive
