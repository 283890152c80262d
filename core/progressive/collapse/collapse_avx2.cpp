// The collapse kernel for processors with AVX2. Only this file is compiled for them; without that (other processors,
// other compilers) it is the plain kernel under the other name, and nothing asks for it.
#include "core/progressive/collapse/collapse_lanes.h"
#include "core/progressive/collapse/kernel_table.h"
#if defined(__AVX2__)
#include "core/progressive/collapse/id_lanes_avx2.h"
#else
#include "core/progressive/collapse/id_lanes_plain.h"
#endif

namespace lodestone::progressive {

#if defined(__AVX2__)
const CollapseKernel avx2_collapse_kernel = kernel_of<avx2::Lanes>();
#else
const CollapseKernel avx2_collapse_kernel = kernel_of<plain::Lanes>();
#endif

}  // namespace lodestone::progressive
