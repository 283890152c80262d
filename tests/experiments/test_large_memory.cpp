// Huge pages for large arrays, and freed memory that is used again.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <new>
#include <sstream>
#include <string>

#include "experiments/large_memory.h"

namespace lodestone {
namespace {

constexpr std::size_t bytes = std::size_t{64} << 20;

long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_minflt;
}

// Page faults of a new array whose every byte is written.
long faults_of_array(std::size_t size = bytes) {
  const auto array = std::make_unique_for_overwrite<char[]>(size);
  const long before = page_faults();
  std::memset(array.get(), 1, size);
  asm volatile("" : : "r"(array.get()) : "memory");  // or the compiler writes nothing
  return page_faults() - before;
}

// Flags of the mapping that holds an address; empty where the system does not tell.
std::string flags_at(const void* address) {
  std::ifstream file("/proc/self/smaps");
  const auto wanted = reinterpret_cast<std::uintptr_t>(address);
  bool holds = false;
  for (std::string line; std::getline(file, line);) {
    std::uintptr_t begin = 0, end = 0;
    char dash = 0;
    if (std::istringstream words(line); words >> std::hex >> begin >> dash >> end && dash == '-')
      holds = begin <= wanted && wanted < end;
    else if (holds && line.starts_with("VmFlags:"))
      return line;
  }
  return {};
}

// Before the others: these keep all of it from then on.
TEST(LargeMemory, GoesBackWhereMemoryIsLimited) {
  return_large_memory();
  const long all = faults_of_array(bytes), again = faults_of_array(bytes);
  EXPECT_GT(all, 0);
  EXPECT_GT(again, all / 2) << "the pages are new ones";
  constexpr std::size_t small = bytes / 4;
  (void)faults_of_array(small);
  EXPECT_EQ(faults_of_array(small), 0);
}

TEST(LargeMemory, IsToLieInHugePages) {
  keep_large_memory();
  const auto array = std::make_unique_for_overwrite<char[]>(bytes);
  const std::string flags = flags_at(array.get() + bytes / 2);
  if (flags.empty() || !std::filesystem::exists("/sys/kernel/mm/transparent_hugepage")) GTEST_SKIP() << "no huge pages here";
  EXPECT_NE(flags.find(" hg"), std::string::npos) << flags;
}

TEST(LargeMemory, IsKept) {
  keep_large_memory();
  (void)faults_of_array();
  EXPECT_EQ(faults_of_array(), 0);
}

TEST(LargeMemory, AsksTheHandlerWhenThereIsNone) {
  keep_large_memory();
  static int asked = 0;
  std::set_new_handler([] {
    ++asked;
    std::set_new_handler(nullptr);
  });
  volatile std::size_t too_many = std::size_t{1} << 62;
  EXPECT_THROW(::operator delete(::operator new(too_many)), std::bad_alloc);
  EXPECT_EQ(asked, 1);
}

}  // namespace
}  // namespace lodestone
