// Rounding outward, against rational arithmetic.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/math/round_up.h"
#include "tests/stability/exact.h"

namespace lodestone::test {
namespace {

double random_double(std::mt19937_64& random, int exponents) {
  const double mantissa = 1 + std::ldexp(static_cast<double>(random() >> 12), -52);
  return std::ldexp(mantissa, static_cast<int>(random() % static_cast<unsigned>(2 * exponents)) - exponents);
}

// The least double that is not below the exact value; one more where rounding errors have no double.
void expect_up(double found, const Rational& value, bool tight = true) {
  ASSERT_TRUE(std::isfinite(found));
  EXPECT_GE(Rational(found), value);
  if (tight) {
    EXPECT_LT(Rational(std::nextafter(found, -HUGE_VAL)), value);
  }
}

TEST(RoundUp, GivesTheLeastDoubleThatIsNotBelow) {
  std::mt19937_64 random(1);
  for (const int exponents : {1, 60, 300})
    for (int k = 0; k < 2000; ++k) {
      const double a = random_double(random, exponents), b = random_double(random, exponents);
      expect_up(sum_up(a, b), Rational(a) + Rational(b));
      expect_up(sum_up(a, -b), Rational(a) - Rational(b));
      expect_up(product_up(a, b), Rational(a) * Rational(b), product_up(a, b) > 0x1p-900);
      expect_up(quotient_up(a, b), Rational(a) / Rational(b));
      const double root = root_up(a);
      EXPECT_GE(square(Rational(root)), Rational(a));
      EXPECT_LT(square(Rational(std::nextafter(root, 0))), Rational(a));
      EXPECT_GE(square(Rational(length_up({a, -b, a}))), square(Rational(a)) * 2 + square(Rational(b)));
    }
}

TEST(RoundUp, HoldsWhereErrorsHaveNoDouble) {
  constexpr double least = std::numeric_limits<double>::denorm_min();
  for (const double a : {0.0, least, 3 * least, 0x1p-1022, 0x1.8p-1000, 0x1p-961, 1 + 0x1p-52, 0x1.8p1000})
    for (const double b : {0.0, least, 0x1.1p-1022, 0x1.7p-500, 1 / 3.0, 3.0}) {
      expect_up(sum_up(a, b), Rational(a) + Rational(b));
      expect_up(product_up(a, b), Rational(a) * Rational(b), false);
      EXPECT_GE(square(Rational(root_up(a))), Rational(a));
      if (b > 0x1p-20) expect_up(quotient_up(a, b), Rational(a) / Rational(b), false);
    }
  EXPECT_EQ(product_up(0, 3), 0);
  EXPECT_EQ(quotient_up(0, 3), 0);
  EXPECT_EQ(root_up(0), 0);
  EXPECT_EQ(sum_up(1e308, 1e308), HUGE_VAL);
  EXPECT_EQ(product_up(1e308, 1e308), HUGE_VAL);
}

TEST(RoundUp, GivesFloatsOnBothSides) {
  std::mt19937_64 random(2);
  for (int k = 0; k < 2000; ++k) {
    const double v = (k % 2 ? -1 : 1) * random_double(random, 100);
    EXPECT_GE(float_up(v), v);
    EXPECT_LT(std::nextafter(float_up(v), -HUGE_VALF), v);
    EXPECT_LE(float_down(v), v);
    EXPECT_GT(std::nextafter(float_down(v), HUGE_VALF), v);
    EXPECT_GE(float_above(std::abs(v)), std::abs(v) * (1 + 0x1p-25));
  }
  EXPECT_EQ(float_up(0.5), 0.5f);
  EXPECT_EQ(float_down(0.5), 0.5f);
  EXPECT_GT(float_above(0.5), 0.5f);
  EXPECT_EQ(float_above(0), 0);
  EXPECT_GT(float_up(1e-300), 0);
}

}  // namespace
}  // namespace lodestone::test
