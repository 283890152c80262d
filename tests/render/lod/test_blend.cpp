// Blending functions: ends, monotony, the Lipschitz constant that bounds pops.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "core/base/error.h"
#include "render/lod/blend.h"
#include "render/lod/blend_curve.h"
#include "tests/expect_error.h"
#include "tests/render/own_blends.h"

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
    // Rounding may turn a polynomial's last digit.
    EXPECT_GE(share, before - (curve_of(GetParam()) ? 1e-6f : 0.0f)) << at(i);
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

TEST_P(EachBlend, IsFoundByItsName) { EXPECT_EQ(blend_named(name_of(GetParam())), GetParam()); }

INSTANTIATE_TEST_SUITE_P(All, EachBlend, ::testing::ValuesIn(all_blends().begin(), all_blends().end()),
                         [](const auto& instance) { return std::string(name_of(instance.param)); });
INSTANTIATE_TEST_SUITE_P(Own, EachBlend, ::testing::ValuesIn(test::own_blends()));

TEST(OwnBlend, IsTheSameForTheSameCurve) {
  const Blend own = blend_named("table:0,0.5,1");
  EXPECT_EQ(own_blend({BlendCurve::Kind::table, {0, 0.5f, 1}}), own);
  EXPECT_EQ(blend_named("table:0.0,5e-1,1"), own);
  EXPECT_EQ(name_of(own), "table:0,0.5,1");
  EXPECT_NE(blend_named("table:0,0.25,1"), own);
  EXPECT_EQ(all_blends().size(), 7u);
}

// By sampling, which is slow and knows nothing of control points.
TEST(OwnBlend, LipschitzConstantsBoundTheSlopesOfManyPolynomials) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> number(-3, 3);
  int accepted = 0, refused = 0;
  for (int i = 0; i < 4000; ++i) {
    BlendCurve curve{BlendCurve::Kind::polynomial, {0}};
    const std::size_t degree = 1 + random() % 5;
    double sum = 0;
    for (std::size_t k = 1; k < degree; ++k) sum += static_cast<double>(curve.values.emplace_back(number(random)));
    curve.values.push_back(static_cast<float>(1 - sum));
    const auto slope = [&](double t) {
      double s = 0;
      for (std::size_t k = degree; k > 0; --k)
        s = s * t + static_cast<double>(k) * static_cast<double>(curve.values[k]);
      return s;
    };
    double least = 0, most = 0;
    for (int s = 0; s <= 2000; ++s) {
      least = std::min(least, slope(s / 2000.0));
      most = std::max(most, slope(s / 2000.0));
    }
    try {
      check_curve(curve);
      ++accepted;
      EXPECT_GE(least, -1e-4) << text_of(curve);
      EXPECT_GE(curve_lipschitz(curve), most) << text_of(curve);
      EXPECT_LE(curve_lipschitz(curve), most * 1.001) << text_of(curve);
    } catch (const InputError&) {
      ++refused;
      EXPECT_LT(least, 0) << text_of(curve);
    }
  }
  EXPECT_GT(accepted, 300);
  EXPECT_GT(refused, 300);
}

TEST(OwnBlend, OthersAreRefused) {
  const auto refused = [](const std::string& text, const std::string& what) {
    expect_error_of<InputError>([&] { (void)blend_named(text); }, {text, what});
  };
  refused("table:0", "2 to 65");
  refused("table:", "number");
  refused("table:0,x,1", "'x,1'");
  refused("table:0,1,", "number");
  refused("table:0,nan,1", "million");
  refused("table:0,0.6,0.5,1", "decreases");
  refused("table:0.5,1", "must be 0 at 0 and 1 at 1");
  refused("polynomial:0,2", "must be 0 at 0 and 1 at 1");
  refused("polynomial:0,3,-2", "decreases");
  refused("polynomial:0,-1,2", "decreases");
  refused("polynomial:0,0,0,0,0,0,0,0,1", "9 values");
  refused("curve:0,1", "table:0");
}

TEST(Blend, EarlyIsDoneHalfWayAndLateHasNotStarted) {
  EXPECT_EQ(blend_share(Blend::early, 0.5f), 1);
  EXPECT_EQ(blend_share(Blend::late, 0.5f), 0);
}

TEST(Blend, StepJumps) {
  EXPECT_EQ(blend_share(Blend::step, 0.4999f), 0);
  EXPECT_EQ(blend_share(Blend::step, 0.5f), 1);
}

TEST(Blend, UnknownNameIsRefusedWithTheKnownOnes) {
  expect_error_of<InputError>([] { return blend_named("smotherstep"); }, {"smootherstep"});
}

}  // namespace
}  // namespace lodestone
