// What kernels in lanes are compiled for.
#pragma once

namespace lodestone {

enum class InstructionSet { best, plain, avx2 };

// Whether this machine can run it; `best` and `plain` always.
[[nodiscard]] inline bool is_available(InstructionSet set) {
#if defined(__x86_64__)
  return set != InstructionSet::avx2 || __builtin_cpu_supports("avx2");
#else
  return set != InstructionSet::avx2;
#endif
}

}  // namespace lodestone
