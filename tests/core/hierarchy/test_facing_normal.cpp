// One normal for the triangles of a corner against directions tried by the thousand.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/hierarchy/construct/facing_normal.h"

namespace lodestone {
namespace {

constexpr double far_cosine = 0.5;

struct Stars {
  std::mt19937 random{5};
  std::normal_distribution<double> gauss;

  Vec3d direction() {
    const Vec3d d{gauss(random), gauss(random), gauss(random)};
    return (1 / length(d)) * d;
  }
  // Triangles of any area within that angle of an axis.
  std::vector<Vec3d> around(Vec3d axis, double cosine) {
    std::vector<Vec3d> star;
    while (star.size() < 1 + random() % 9)
      if (const Vec3d d = direction(); dot(axis, d) >= cosine) star.push_back(std::exp(gauss(random)) * d);
    return star;
  }
};

double area_within(const std::vector<Vec3d>& star, Vec3d n) {
  double area = 0;
  for (const Vec3d& t : star)
    if (dot(t, n) >= (far_cosine - 1e-9) * length(t)) area += length(t);
  return area;
}
double area_of(const std::vector<Vec3d>& star) {
  double area = 0;
  for (const Vec3d& t : star) area += length(t);
  return area;
}

TEST(FacingNormal, IsNearAllWhereOneIs) {
  Stars stars;
  for (int k = 0; k < 2000; ++k) {
    const std::vector<Vec3d> star = stars.around(stars.direction(), std::cos(0.92));  // 53 degrees
    const Vec3d n = facing_normal(star);
    EXPECT_NEAR(length(n), 1, 1e-12);
    EXPECT_EQ(area_within(star, n), area_of(star));
  }
}

// The means of such stars lose 17 % of the area, the best of many directions 7 %.
TEST(FacingNormal, GivesUpLittle) {
  Stars stars;
  double given_up = 0, least = 0, all = 0;
  for (int k = 0; k < 300; ++k) {
    const std::vector<Vec3d> star = stars.around(stars.direction(), -0.3);
    double best = 0;
    for (int i = 0; i < 1000; ++i) best = std::max(best, area_within(star, stars.direction()));
    const double area = area_of(star), kept = area_within(star, facing_normal(star));
    given_up += (area - kept) / area, least += (area - best) / area, all += 1;
  }
  EXPECT_LE(given_up, 1.15 * least);
  EXPECT_LE(least, 0.2 * all);
}

// At the tip of a sharp cone no normal is near to all; one triangle after the other would take minutes.
TEST(FacingNormal, OfThousandsAtATip) {
  std::vector<Vec3d> star;
  for (int k = 0; k < 100'000; ++k) {
    const double turn = k * 6.283185307179586 / 100'000;
    star.push_back({std::cos(turn), std::sin(turn), 0.1});
  }
  EXPECT_GT(area_within(star, facing_normal(star)), 0.25 * area_of(star));
}

TEST(FacingNormal, OfDegenerateStars) {
  EXPECT_EQ(facing_normal({}), Vec3d{});
  EXPECT_EQ(facing_normal({Vec3d{}, Vec3d{}}), Vec3d{});
  EXPECT_EQ(facing_normal({Vec3d{}, Vec3d{0, 2e-20, 0}}), (Vec3d{0, 1, 0}));
  EXPECT_EQ(facing_normal({Vec3d{0, 0, 2}, Vec3d{0, 0, -3}}), (Vec3d{0, 0, -1}));
  EXPECT_EQ(facing_normal({Vec3d{0, 0, 2}, Vec3d{0, 0, -2}}), (Vec3d{0, 0, 1}));
}

}  // namespace
}  // namespace lodestone
