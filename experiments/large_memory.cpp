#include "experiments/large_memory.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#if defined(LODESTONE_SANITIZED) || !defined(__GLIBC__)  // sanitizers watch operators of their own

namespace lodestone {

void return_large_memory() {}
void return_free_memory() {}
void keep_large_memory() {}

}  // namespace lodestone

#else

namespace lodestone {

namespace {

constexpr std::size_t huge_page = std::size_t{2} << 20;
// Smaller arrays have too few whole pages within.
constexpr std::size_t large = 4 * huge_page;
// Threads that share a heap: memory that one of them frees serves the others. Small allocations do not come this far.
constexpr int threads_per_heap = 8;
// Memory at the end of the heap that is given back to the system only when there is more of it free.
constexpr int kept_bytes = 1 << 30;
// Larger arrays are parts of no heap (the largest that malloc accepts for this).
constexpr int returned_bytes = 32 << 20;

bool wants_huge_pages = false;

void make_huge(void* array, std::size_t bytes) {
  const auto address = reinterpret_cast<std::uintptr_t>(array);
  const std::uintptr_t begin = (address + huge_page - 1) / huge_page * huge_page,
                       end = (address + bytes) / huge_page * huge_page;
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

void use_huge_pages_and_keep_heaps() {
  mallopt(M_TRIM_THRESHOLD, kept_bytes);
  wants_huge_pages = true;
}

}  // namespace

void return_large_memory() {
  use_huge_pages_and_keep_heaps();
  mallopt(M_MMAP_THRESHOLD, returned_bytes);
}

void return_free_memory() { malloc_trim(0); }

void keep_large_memory() {
  use_huge_pages_and_keep_heaps();
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_ARENA_MAX, 1 + static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN)) / threads_per_heap);
}

}  // namespace lodestone

void* operator new(std::size_t bytes) {
  for (;;) {
    if (void* const memory = std::malloc(std::max<std::size_t>(bytes, 1))) {
      if (lodestone::wants_huge_pages && bytes >= lodestone::large) lodestone::make_huge(memory, bytes);
      return memory;
    }
    const std::new_handler handler = std::get_new_handler();
    if (!handler) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

#endif
