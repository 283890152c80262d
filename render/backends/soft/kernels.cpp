#include "render/backends/soft/kernels.h"

namespace lodestone::soft {

const Kernels& find_kernels(InstructionSet set) {
#if defined(__x86_64__)
  return *choose_kernel(set, &plain::kernels, &avx2::kernels);
#else
  return *choose_kernel(set, &plain::kernels, &plain::kernels);
#endif
}

}  // namespace lodestone::soft
