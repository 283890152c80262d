// The exact predicate against whole numbers of any length.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "core/math/orientation.h"

namespace lodestone::spherical {
namespace {

// A whole number by sign and digits of 32 bits, the lowest first.
struct Whole {
  int sign = 0;
  std::vector<std::uint32_t> digits;
};

void trim(Whole& a) {
  while (!a.digits.empty() && a.digits.back() == 0) a.digits.pop_back();
  if (a.digits.empty()) a.sign = 0;
}

// x times 2^400, for multiples of 2^-400.
Whole whole(double x) {
  int exponent = 0;
  auto mantissa = static_cast<std::uint64_t>(std::ldexp(std::abs(std::frexp(x, &exponent)), 53));
  Whole out{x > 0 ? 1 : x < 0 ? -1 : 0, std::vector<std::uint32_t>(64, 0)};
  int place = exponent - 53 + 400;
  for (; mantissa != 0; mantissa >>= 1, ++place)
    if ((mantissa & 1) != 0) out.digits.at(static_cast<std::size_t>(place / 32)) |= 1u << (place % 32);
  trim(out);
  return out;
}

Whole times(const Whole& a, const Whole& b) {
  Whole out{a.sign * b.sign, std::vector<std::uint32_t>(a.digits.size() + b.digits.size() + 1, 0)};
  for (std::size_t i = 0; i < a.digits.size(); ++i) {
    std::uint64_t carry = 0;
    for (std::size_t j = 0; j < b.digits.size() || carry != 0; ++j) {
      carry += out.digits[i + j] + std::uint64_t{a.digits[i]} * (j < b.digits.size() ? b.digits[j] : 0);
      out.digits[i + j] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
  }
  trim(out);
  return out;
}

int compare_size(const Whole& a, const Whole& b) {
  if (a.digits.size() != b.digits.size()) return a.digits.size() < b.digits.size() ? -1 : 1;
  for (std::size_t k = a.digits.size(); k-- > 0;)
    if (a.digits[k] != b.digits[k]) return a.digits[k] < b.digits[k] ? -1 : 1;
  return 0;
}

Whole plus(const Whole& a, const Whole& b) {
  if (compare_size(a, b) < 0) return plus(b, a);
  Whole out = a;
  out.digits.push_back(0);
  std::int64_t carry = 0;
  for (std::size_t k = 0; k < out.digits.size(); ++k) {
    const std::int64_t digit = k < b.digits.size() ? b.digits[k] : 0;
    carry += out.digits[k] + (a.sign == b.sign ? digit : -digit);
    out.digits[k] = static_cast<std::uint32_t>(carry);
    carry >>= 32;
  }
  trim(out);
  return out;
}

int orientation_in_whole_numbers(Vec3d a, Vec3d b, Vec3d c) {
  const auto product = [](double x, double y, double z) { return times(times(whole(x), whole(y)), whole(z)); };
  Whole sum = product(a.x, b.y, c.z);
  for (const Whole& term : {product(-a.x, b.z, c.y), product(a.y, b.z, c.x), product(-a.y, b.x, c.z),
                            product(a.z, b.x, c.y), product(-a.z, b.y, c.x)})
    sum = plus(sum, term);
  return sum.sign;
}

Vec3d unit(Vec3d v) { return (1 / length(v)) * v; }

class Directions {
 public:
  Vec3d any() { return unit({normal_(random_), normal_(random_), normal_(random_)}); }
  double share() { return uniform_(random_); }
  double ulps(double x) {
    for (int k = static_cast<int>(random_() % 5); k > 0; --k) x = std::nextafter(x, random_() % 2 == 0 ? 2 : -2);
    return x;
  }
  Vec3d ulps(Vec3d p) { return {ulps(p.x), ulps(p.y), ulps(p.z)}; }

 private:
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_{0, 1};
  std::uniform_real_distribution<double> uniform_{0, 1};
};

void expect_as_in_whole_numbers(Vec3d a, Vec3d b, Vec3d c) {
  const int expected = orientation_in_whole_numbers(a, b, c);
  ASSERT_EQ(orientation(a, b, c), expected);
  ASSERT_EQ(orientation(b, c, a), expected);
  ASSERT_EQ(orientation(b, a, c), -expected);
}

TEST(Orientation, TellsTheSidesOfTheAxes) {
  EXPECT_EQ(orientation({1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_EQ(orientation({0, 1, 0}, {1, 0, 0}, {0, 0, 1}), -1);
  EXPECT_EQ(orientation({1, 0, 0}, {0, 1, 0}, {1, 1, 0}), 0);
  EXPECT_EQ(orientation({}, {0, 1, 0}, {1, 1, 0}), 0);
}

TEST(Orientation, IsExactForAnyDirections) {
  Directions directions;
  for (int k = 0; k < 500; ++k)
    ASSERT_NO_FATAL_FAILURE(expect_as_in_whole_numbers(directions.any(), directions.any(), directions.any()));
}

TEST(Orientation, IsExactForDirectionsNearlyInAPlane) {
  Directions directions;
  int zero = 0, positive = 0, negative = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vec3d a = directions.any();
    const Vec3d b = k % 3 == 0 ? unit(a + 1e-7 * directions.any()) : directions.any();
    const double s = directions.share();
    const Vec3d c = directions.ulps(snapped(unit(s * a + (1 - s) * b)));
    ASSERT_NO_FATAL_FAILURE(expect_as_in_whole_numbers(snapped(a), snapped(b), c));
    const int sign = orientation(snapped(a), snapped(b), c);
    zero += sign == 0, positive += sign > 0, negative += sign < 0;
  }
  EXPECT_GT(positive, 100);
  EXPECT_GT(negative, 100);
}

TEST(Orientation, IsExactInThePlane) {
  Directions directions;
  int zero = 0, positive = 0, negative = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vec3d p = directions.any(), q = directions.any();
    const double s = k % 2 == 0 ? 0.5 : directions.share(), offset = k % 3 == 0 ? 1e7 : 0;
    const Vec2d a{p.x + offset, p.y}, b{q.x + offset, k % 5 == 0 ? p.y : q.y};
    Vec2d c{s * a.x + (1 - s) * b.x, s * a.y + (1 - s) * b.y};
    if (k % 7 != 0) c = {directions.ulps(c.x), c.y};
    const int expected = orientation_in_whole_numbers({a.x, a.y, 1}, {b.x, b.y, 1}, {c.x, c.y, 1});
    ASSERT_EQ(orientation(a, b, c), expected);
    ASSERT_EQ(orientation(b, c, a), expected);
    ASSERT_EQ(orientation(b, a, c), -expected);
    zero += expected == 0, positive += expected > 0, negative += expected < 0;
  }
  EXPECT_GT(std::min({zero, positive, negative}), 100);
}

TEST(Orientation, FindsExactZerosAndTheSmallestDifferences) {
  Directions directions;
  for (int k = 0; k < 300; ++k) {
    // Multiples of 2^-20: twice a minus b is exact.
    const auto coarse = [](double x) { return std::round(x * 0x1p20) * 0x1p-20; };
    const Vec3d p = directions.any(), q = directions.any();
    const Vec3d a{coarse(p.x), coarse(p.y), coarse(p.z)}, b{coarse(q.x), coarse(q.y), coarse(q.z)}, c = 2.0 * a - b;
    ASSERT_EQ(orientation(a, b, c), 0);
    ASSERT_NO_FATAL_FAILURE(expect_as_in_whole_numbers(a, b, {std::nextafter(c.x, 9), c.y, c.z}));
    ASSERT_NO_FATAL_FAILURE(expect_as_in_whole_numbers(a, b, {c.x + 0x1p-200, c.y, c.z}));
    ASSERT_NO_FATAL_FAILURE(expect_as_in_whole_numbers({0x1p-290, a.y, a.z}, {0x1p-280, b.y, b.z}, c));
  }
}

TEST(Orientation, SnappedDirectionsHaveNoTinyCoordinates) {
  EXPECT_EQ(snapped({1e-17, -1e-300, 1}), (Vec3d{0, 0, 1}));
  const Vec3d p = snapped({0.1, -0.7, 0.3});
  EXPECT_LT(length(p - Vec3d{0.1, -0.7, 0.3}), 4e-16);
  EXPECT_EQ(snapped(p), p);
}

}  // namespace
}  // namespace lodestone::spherical
