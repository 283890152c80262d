// The choice among builds of a kernel.
#include <gtest/gtest.h>

#include "core/base/instruction_set.h"

namespace lodestone {
namespace {

TEST(InstructionSets, AreChosenAmongThoseThatTheProcessorHas) {
  for (const InstructionSet set : {InstructionSet::plain, InstructionSet::avx2, InstructionSet::avx512}) {
    const int number = static_cast<int>(set);
    if (is_available(set))
      EXPECT_EQ(choose_kernel(set, 1, 2, 3), number);
    else
      EXPECT_THROW((void)choose_kernel(set, 1, 2, 3), UnsupportedError);
  }
}

TEST(InstructionSets, BestIsTheLastThatIsAvailable) {
  int last = 1;
  for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512})
    if (is_available(set)) last = static_cast<int>(set);
  EXPECT_EQ(choose_kernel(InstructionSet::best, 1, 2, 3), last);
}

TEST(InstructionSets, KernelsWithoutABuildForAvx512DoWithAvx2) {
  if (!is_available(InstructionSet::avx512)) GTEST_SKIP() << "no AVX-512 here";
  for (const InstructionSet set : {InstructionSet::best, InstructionSet::avx512}) {
    EXPECT_EQ(choose_kernel(set, 1, 2), 2);
    EXPECT_EQ(choose_kernel(set, 1, 2, 0), 2) << "the compiler made none";
  }
}

}  // namespace
}  // namespace lodestone
