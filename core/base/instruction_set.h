// The instruction sets that kernels are compiled for, and the choice among their builds.
#pragma once

#include "core/base/error.h"

// A kernel is compiled once for each set, in a namespace of this name, so that the linker cannot confuse the builds.
#if defined(__AVX2__)
#define LODESTONE_LANES avx2
#else
#define LODESTONE_LANES plain
#endif

namespace lodestone {

enum class InstructionSet { best, plain, avx2 };

// True if this processor can run it; `best` and `plain` always.
[[nodiscard]] inline bool is_available(InstructionSet set) {
#if defined(__x86_64__)
  return set != InstructionSet::avx2 || __builtin_cpu_supports("avx2");
#else
  return set != InstructionSet::avx2;
#endif
}

// The build of a kernel for a set. Throws UnsupportedError where this processor does not have the set.
template <class Kernel>
[[nodiscard]] Kernel choose_kernel(InstructionSet set, Kernel plain, Kernel avx2) {
  if (!is_available(set))
    throw UnsupportedError("this processor has no AVX2; choose the instruction set 'plain' or 'best'");
  return set != InstructionSet::plain && is_available(InstructionSet::avx2) ? avx2 : plain;
}

}  // namespace lodestone
