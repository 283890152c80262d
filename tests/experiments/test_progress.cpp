// The line of the progress bar.
#include <gtest/gtest.h>

#include "experiments/command_line/progress.h"

namespace lodestone {
namespace {

TEST(ProgressLine, ShowsAmountsRateAndTimeLeft) {
  EXPECT_EQ(progress_line("building", 0.5, 4, 56e6, "triangles"),
            "building   [###############...............]  50 %  28 of 56 M triangles, 7 M/s, 4 s left");
  EXPECT_EQ(progress_line("building", 1, 10, 5e3, "triangles"),
            "building   [##############################] 100 %  5e+03 of 5e+03 triangles, 500/s, 0 s left");
  EXPECT_EQ(progress_line("rendering", 0.25, 30, 120, "frames"),
            "rendering  [#######.......................]  25 %  30 of 120 frames, 1/s, 90 s left");
}

TEST(ProgressLine, WithoutAnAmountHasNoRate) {
  EXPECT_EQ(progress_line("comparing", 0.1, 20), "comparing  [###...........................]  10 %  3 min 0 s left");
}

TEST(ProgressLine, SaysNothingOfTheTimeLeftBeforeItKnows) {
  EXPECT_EQ(progress_line("building", 0, 4, 56e6, "triangles"),
            "building   [..............................]   0 %  0 of 56 M triangles, 0/s");
  EXPECT_EQ(progress_line("building", 0.5, 36000),
            "building   [###############...............]  50 %  10 h 0 min left");
}

}  // namespace
}  // namespace lodestone
