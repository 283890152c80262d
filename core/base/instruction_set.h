// The instruction sets that kernels are compiled for, and the choice among their builds.
#pragma once

#include "core/base/error.h"

// A kernel is compiled once for each set, in a namespace of this name, so that the linker cannot confuse the builds.
#if defined(__AVX512VL__) && defined(__AVX512BW__) && defined(__AVX512VBMI2__)
#define LODESTONE_LANES avx512
#elif defined(__AVX2__)
#define LODESTONE_LANES avx2
#else
#define LODESTONE_LANES plain
#endif

namespace lodestone {

// Each includes those before it. The last one is used on registers of 256 bits: masks and shifts of lanes are what it
// adds.
enum class InstructionSet { best, plain, avx2, avx512 };

// True if this processor can run it; `best` and `plain` always.
[[nodiscard]] inline bool is_available(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512)
    return __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512vbmi2");
  return set != InstructionSet::avx2 || __builtin_cpu_supports("avx2");
#else
  return set == InstructionSet::best || set == InstructionSet::plain;
#endif
}

// The build of a kernel for a set; some kernels have none of their own for AVX-512, which then do with that for AVX2.
// Throws UnsupportedError where this processor does not have the set.
template <class Kernel>
[[nodiscard]] Kernel choose_kernel(InstructionSet set, Kernel plain, Kernel avx2, Kernel avx512) {
  if (!is_available(set))
    throw UnsupportedError("this processor does not have the instruction set; choose 'plain' or 'best'");
  if (set == InstructionSet::best)
    set = is_available(InstructionSet::avx512) ? InstructionSet::avx512
          : is_available(InstructionSet::avx2) ? InstructionSet::avx2
                                               : InstructionSet::plain;
  return set == InstructionSet::plain ? plain : set == InstructionSet::avx2 ? avx2 : avx512;
}
template <class Kernel>
[[nodiscard]] Kernel choose_kernel(InstructionSet set, Kernel plain, Kernel avx2) {
  return choose_kernel(set, plain, avx2, avx2);
}

}  // namespace lodestone
