// Programs that use a process for long: memory that must not grow, and a folder.
#pragma once

#include <malloc.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "core/base/error.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone::soak {

namespace fs = std::filesystem;

[[noreturn]] inline void fail(const std::string& what) {
  std::fprintf(stderr, "soak: %s\n", what.c_str());
  std::exit(1);
}

// Bytes.
struct Memory {
  std::uint64_t resident = 0, allocated = 0;
  // Free room that the allocator keeps depends on which thread allocated when: it is given back first.
  static Memory now() {
    malloc_trim(0);
    std::ifstream statm("/proc/self/statm");
    std::uint64_t pages = 0, resident = 0;
    statm >> pages >> resident;
    const auto heap = mallinfo2();
    return {resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)), heap.uordblks + heap.hblkhd};
  }
};

inline double mib(std::uint64_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

// Memory at the beginning, once everything has been used, and from then on.
class Growth {
 public:
  Growth(std::uint64_t allocated_limit, std::uint64_t resident_limit)
      : allocated_limit_(allocated_limit), resident_limit_(resident_limit) {}

  void middle() { middle_ = Memory::now(); }
  void end(bool check = true) const {
    const Memory last = Memory::now();
    std::printf("resident: %.1f, %.1f, %.1f MiB; allocated: %.3f, %.3f, %.3f MiB (beginning, middle, end)\n",
                mib(first_.resident), mib(middle_.resident), mib(last.resident), mib(first_.allocated),
                mib(middle_.allocated), mib(last.allocated));
    if (!check) return;
    if (last.allocated > first_.allocated + allocated_limit_) fail("allocated memory has grown");
    if (last.resident > first_.resident + resident_limit_) fail("the resident set has grown");
  }

 private:
  std::uint64_t allocated_limit_, resident_limit_;
  Memory first_ = Memory::now(), middle_;
};

class Folder {
 public:
  Folder() { fs::create_directories(path); }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path path = fs::temp_directory_path() / ("lodestone-soak." + std::to_string(getpid()));
};

// Calls work(folder, scheduler), and returns the status of the program: 0, 1 for what went wrong, 77 for what cannot be
// had here.
inline int run(const std::function<void(const fs::path& folder, Scheduler& scheduler)>& work) {
  mallopt(M_ARENA_MAX, 1);  // malloc_trim leaves the free ends of other heaps
  try {
    const Folder folder;
    work(folder.path, *make_tbb_scheduler(2));
    return 0;
  } catch (const UnsupportedError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 77;
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

}  // namespace lodestone::soak
