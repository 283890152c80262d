// Where large arrays lie, and what becomes of their memory.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstring>
#include <fstream>
#include <memory>
#include <new>
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
long faults_of_array() {
  const auto array = std::make_unique_for_overwrite<char[]>(bytes);
  const long before = page_faults();
  std::memset(array.get(), 1, bytes);
  return page_faults() - before;
}

bool has_huge_pages() {
  std::ifstream file("/sys/kernel/mm/transparent_hugepage/enabled");
  std::string line;
  return std::getline(file, line) && line.find("[never]") == std::string::npos;
}

TEST(LargeMemory, LiesInHugePagesAndIsKept) {
  keep_large_memory();
  if (has_huge_pages()) {
    EXPECT_LT(faults_of_array(), 2000);  // 16,384 pages of 4 kB
  }
  (void)faults_of_array();
  EXPECT_LT(faults_of_array(), 100);  // the memory of the one before
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
