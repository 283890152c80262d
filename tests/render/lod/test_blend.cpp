// Blending functions: ends, monotony, the Lipschitz constant that bounds pops.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/error.h"
#include "render/lod/blend.h"
#include "tests/expect_error.h"

namespace lodestone {
namespace {

class EachBlend : public ::testing::TestWithParam<Blend> {};

constexpr int steps = 20000;
float at(int i) { return static_cast<float>(i) / steps; }

TEST_P(EachBlend, GoesFromZeroToOneExactly) {
  const Blend b = GetParam();
  EXPECT_EQ(blend_share(b, 0), 0);
  EXPECT_EQ(blend_share(b, 1), 1);
  EXPECT_EQ(blend_share(b, -3), 0);
  EXPECT_EQ(blend_share(b, 7), 1);
  EXPECT_EQ(blend_share(b, std::nanf("")), 0);
}

TEST_P(EachBlend, NeverDecreases) {
  float before = 0;
  for (int i = 0; i <= steps; ++i) {
    const float share = blend_share(GetParam(), at(i));
    EXPECT_GE(share, before) << at(i);
    EXPECT_LE(share, 1);
    before = share;
  }
}

TEST_P(EachBlend, KeepsItsLipschitzConstantAndReachesIt) {
  if (GetParam() == Blend::step) {  // has none; its jumps are measured against linear
    EXPECT_EQ(blend_lipschitz(Blend::step), blend_lipschitz(Blend::linear));
    return;
  }
  const double claimed = blend_lipschitz(GetParam());
  double steepest = 0;
  constexpr int stride = 20;  // wide enough that the rounding of the shares does not count
  for (int i = 0; i + stride <= steps; ++i)
    steepest = std::max(steepest, (double{blend_share(GetParam(), at(i + stride))} - blend_share(GetParam(), at(i))) /
                                      (double{at(i + stride)} - at(i)));
  EXPECT_LE(steepest, claimed * (1 + 1e-3));
  EXPECT_GE(steepest, claimed * (1 - 1e-3));
}

TEST_P(EachBlend, IsFoundByItsName) { EXPECT_EQ(blend(name_of(GetParam())), GetParam()); }

INSTANTIATE_TEST_SUITE_P(All, EachBlend, ::testing::ValuesIn(all_blends().begin(), all_blends().end()),
                         [](const auto& instance) { return std::string(name_of(instance.param)); });

TEST(Blend, EarlyIsDoneHalfWayAndLateHasNotStarted) {
  EXPECT_EQ(blend_share(Blend::early, 0.5f), 1);
  EXPECT_EQ(blend_share(Blend::late, 0.5f), 0);
}

TEST(Blend, StepJumps) {
  EXPECT_EQ(blend_share(Blend::step, 0.4999f), 0);
  EXPECT_EQ(blend_share(Blend::step, 0.5f), 1);
}

TEST(Blend, UnknownNameIsRefusedWithTheKnownOnes) {
  expect_error_of<InputError>([] { return blend("smotherstep"); }, {"smootherstep"});
}

}  // namespace
}  // namespace lodestone
