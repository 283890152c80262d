// The map between square and sphere: inverse, symmetry, borders, stretch.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "core/spherical/octahedron/octahedral_map.h"
#include "core/spherical/octahedron/rough_square.h"
#include "tests/core/spherical/sphere_checks.h"

namespace lodestone::spherical {
namespace {

TEST(OctahedralMap, InverseReturnsToThePoint) {
  test::Numbers number(1);
  double worst_point = 0, worst_direction = 0;
  for (int i = 0; i < 100'000; ++i) {
    const SquarePoint p{number(), number()}, q = square_point(direction_of(p));
    worst_point = std::max({worst_point, std::abs(p.s - q.s), std::abs(p.t - q.t)});
    const Vec3d d = number.direction();
    worst_direction = std::max(worst_direction, length(direction_of(square_point(d)) - d));
    EXPECT_NEAR(length(direction_of(p)), 1, 1e-15);
  }
  EXPECT_LT(worst_point, 1e-14);
  EXPECT_LT(worst_direction, 1e-14);
}

TEST(OctahedralMap, InverseHoldsNearPolesEquatorAndArcs) {
  for (const double tiny : {1e-3, 1e-8, 1e-12, 1e-16, 1e-300})
    for (const double sign : {1.0, -1.0})
      for (const Vec3d d : {Vec3d{1, tiny, tiny}, Vec3d{tiny, 1, sign * tiny}, Vec3d{tiny, tiny, sign},
                            Vec3d{1, 1, sign * tiny}, Vec3d{1, tiny, sign}, Vec3d{tiny, 0.5, sign}}) {
        const Vec3d unit = (1 / length(d)) * d;
        EXPECT_LT(length(direction_of(square_point(d)) - unit), 1e-14);
      }
}

TEST(OctahedralMap, RoughInverseIsWithinItsError) {
  test::Numbers number(2);
  double worst = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const Vec3d d = number.direction();
    const SquarePoint p = square_point(d), q = rough_square_point(d, octant_of(d));
    worst = std::max({worst, std::abs(p.s - q.s), std::abs(p.t - q.t)});
  }
  EXPECT_LT(worst, rough_square_error);
  for (const double x : {-1.0, 1.0})  // on the cut, both copies
    EXPECT_NEAR(rough_square_point({0, 0.6, -0.8}, {x, 1, -1}).s, square_point({0, 0.6, -0.8}, {x, 1, -1}).s,
                rough_square_error);
}

// On points whose coordinates and reflections are exact.
TEST(OctahedralMap, SymmetryIsExact) {
  constexpr int n = 128;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double s = double(i) / n, t = double(j) / n;
      const Vec3d d = direction_of({s, t});
      EXPECT_EQ(direction_of({1 - s, t}), (Vec3d{-d.x, d.y, d.z}));
      EXPECT_EQ(direction_of({s, 1 - t}), (Vec3d{d.x, -d.y, d.z}));
      EXPECT_EQ(direction_of({1 - t, 1 - s}), (Vec3d{d.y, d.x, d.z}));
      // Across the equator, within the quarter of the square.
      const double u = std::abs(2 * s - 1), v = std::abs(2 * t - 1);
      if (s >= 0.5 && t >= 0.5) {
        EXPECT_EQ(direction_of({1 - v / 2, 1 - u / 2}), (Vec3d{d.x, d.y, -d.z})) << s << ' ' << t;
      }
      const SquarePoint p = square_point(d);
      EXPECT_EQ(square_point({-d.x, d.y, d.z}, {-octant_of(d).x, octant_of(d).y, octant_of(d).z}),
                (SquarePoint{1 - p.s, p.t}));
      EXPECT_EQ(square_point({d.y, d.x, d.z}), (SquarePoint{1 - p.t, 1 - p.s}));
    }
}

TEST(OctahedralMap, SidesAreTheArcsExactly) {
  EXPECT_EQ(direction_of({0.5, 0.5}), (Vec3d{0, 0, 1}));
  EXPECT_EQ(direction_of({1, 1}), (Vec3d{0, 0, -1}));
  EXPECT_EQ(direction_of({0, 1}), (Vec3d{0, 0, -1}));
  EXPECT_EQ(direction_of({0.5, 1}), (Vec3d{0, -1, 0}));
  for (int i = 0; i <= 64; ++i) {
    const double a = i / 64.0;
    EXPECT_EQ(direction_of({a, 1}), direction_of({1 - a, 1}));
    EXPECT_EQ(direction_of({0, a}), direction_of({0, 1 - a}));
    EXPECT_EQ(direction_of({a, 1}).x, 0);
    EXPECT_EQ(direction_of({0, a}).y, 0);
    const Vec3d d = direction_of({a, 0});
    EXPECT_EQ(square_point(d, {-1, 1, -1}).t, 0);
    EXPECT_EQ(square_point(d, {1, 1, -1}).t, 0);
    EXPECT_NEAR(square_point(d, {a < 0.5 ? -1.0 : 1.0, 1, -1}).s, a, 1e-15);
    EXPECT_NEAR(square_point(d, {a < 0.5 ? 1.0 : -1.0, 1, -1}).s, 1 - a, 1e-15);
  }
}

// By differences on a fine grid of one octant, where the map is smooth.
TEST(OctahedralMap, StretchesLittleAndFoldsNowhere) {
  constexpr int n = 512;
  constexpr double h = 1e-5, pi = std::numbers::pi;
  double forward = 0, back = 0, area = 0, least = 1e9;
  int count = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      // The centres of the cells of a triangle's grid: two in each square, the second below the diagonal only.
      for (const double third : {1.0 / 3, 2.0 / 3}) {
        const double u = (i + third) / n, v = (j + third) / n;
        if (u + v >= 1) continue;
        const auto at = [](double a, double b) { return direction_of({0.5 + 0.5 * a, 0.5 - 0.5 * b}); };
        const Vec3d by_u = (1 / (2 * h)) * (at(u + h, v) - at(u - h, v));
        const Vec3d by_v = (1 / (2 * h)) * (at(u, v + h) - at(u, v - h));
        const double trace = dot(by_u, by_u) + dot(by_v, by_v), det = dot(cross(by_u, by_v), at(u, v));
        least = std::min(least, det);
        forward += trace / 2 * det, back += trace / 2 / (det * det), area += det;
        ++count;
      }
    }
  const double cell = 0.5 / count;  // of the octant's triangle, whose area is a half; eight of them are the square
  EXPECT_NEAR(8 * cell * area, 4 * pi, 1e-3);
  const double efficiency = std::pow(4 * pi, 2) / (4 * 8 * cell * forward), reverse = 16 / (4 * pi * 8 * cell * back);
  RecordProperty("forward", std::to_string(efficiency));
  RecordProperty("back", std::to_string(reverse));
  EXPECT_GE(efficiency, 0.89);
  EXPECT_GE(reverse, 0.85);
  EXPECT_LT(efficiency, 0.897);  // more than the symmetry allows would be an error of the quadrature
  EXPECT_GT(least / pi, 0.3);
}

}  // namespace
}  // namespace lodestone::spherical
