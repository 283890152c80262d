// The instruction sets that kernels are compiled for, and the choice among their builds.
#pragma once

#include <string>

#include "core/base/error.h"

// A kernel is compiled once for each set, in a namespace of this name, so that the linker cannot confuse the builds.
#if defined(__AVX512VL__) && defined(__AVX512BW__) && defined(__AVX512DQ__) && defined(__AVX512VBMI2__)
#define LODESTONE_AVX512
#define LODESTONE_LANES avx512
#elif defined(__AVX2__)
#define LODESTONE_LANES avx2
#else
#define LODESTONE_LANES plain
#endif

namespace lodestone {

// After `best`, each set includes those before it. AVX-512 is used on registers of 256 bits: it adds masks and shifts
// of lanes.
enum class InstructionSet { best, plain, avx2, avx512 };

// True if this processor can run it; `best` and `plain` always.
[[nodiscard]] inline bool is_available(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512)
    return __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vbmi2");
  return set != InstructionSet::avx2 || __builtin_cpu_supports("avx2");
#else
  return set == InstructionSet::best || set == InstructionSet::plain;
#endif
}

// The build of a kernel for a set. Where there is none for AVX-512 (null, since the compiler does not know it, or not
// given), that for AVX2 serves. Throws UnsupportedError where this processor does not have the set.
template <class Kernel>
[[nodiscard]] Kernel choose_kernel(InstructionSet set, Kernel plain, Kernel avx2, Kernel avx512 = {}) {
  if (!is_available(set))
    throw UnsupportedError(std::string("this processor has no ") + (set == InstructionSet::avx2 ? "AVX2" : "AVX-512") +
                           "; choose the instruction set 'plain' or 'best'");
  if (set == InstructionSet::plain || !is_available(InstructionSet::avx2)) return plain;
  const bool wide = set != InstructionSet::avx2 && is_available(InstructionSet::avx512);
  return wide && avx512 != Kernel{} ? avx512 : avx2;
}

}  // namespace lodestone
