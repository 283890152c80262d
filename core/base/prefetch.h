// Asking for memory that is needed soon: many misses at once instead of one after the other.
#pragma once

#include <cstddef>

namespace lodestone {

// Number of items that a loop over random accesses looks ahead: enough to fill the processor's queue of misses.
inline constexpr std::size_t prefetch_distance = 16;

inline void prefetch(const void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address);
#else
  (void)address;
#endif
}

}  // namespace lodestone
