#include "render/backends/soft/kernels.h"

namespace lodestone::soft {

const Kernels* find_kernels(InstructionSet set) {
#if defined(__x86_64__)
  const bool has_avx2 = __builtin_cpu_supports("avx2");
  if (set == InstructionSet::avx2) return has_avx2 ? &avx2::kernels : nullptr;
  if (set == InstructionSet::best && has_avx2) return &avx2::kernels;
#else
  if (set == InstructionSet::avx2) return nullptr;
#endif
  return &baseline::kernels;
}

}  // namespace lodestone::soft
