#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/camera/placement.h"

namespace lodestone {
namespace {

void expect_near(Vec3d a, Vec3d b, double tolerance = 1e-12) { EXPECT_LE(length(a - b), tolerance * (1 + length(b))); }

Similarity some_similarity() { return {rotation_about_axes({20, -35, 110}), 2.5, {3, -4, 5}}; }

TEST(Placement, TurnsAboutXThenYThenZ) {
  const auto turned = [](Vec3d degrees, Vec3d v) {
    Similarity s;
    s.rotation = rotation_about_axes(degrees);
    return s(v);
  };
  EXPECT_EQ(turned({90, 0, 0}, {0, 1, 0}), (Vec3d{0, 0, 1}));  // exact at right angles
  EXPECT_EQ(turned({0, 90, 0}, {0, 0, 1}), (Vec3d{1, 0, 0}));
  EXPECT_EQ(turned({0, 0, -90}, {0, 1, 0}), (Vec3d{1, 0, 0}));
  EXPECT_EQ(turned({360, 180, 540}, {1, 2, 3}), (Vec3d{1, -2, -3}));
  EXPECT_EQ(turned({90, 0, 90}, {0, 1, 0}), (Vec3d{0, 0, 1}));  // x first: z, which turning about z keeps
  const double a = 30 * std::numbers::pi / 180;
  expect_near(turned({0, 0, 30}, {1, 0, 0}), {std::cos(a), std::sin(a), 0});
}

TEST(Placement, ComposesAndInverts) {
  const Similarity outer = some_similarity(), inner{rotation_about_axes({-70, 15, 5}), 0.125, {-1, 0.5, 9}};
  for (const Vec3d p : {Vec3d{0, 0, 0}, Vec3d{1, 2, 3}, Vec3d{-1e6, 1, 1e-3}}) {
    expect_near((outer * inner)(p), outer(inner(p)));
    expect_near(outer.inverse(outer(p)), p);
    expect_near(outer.rotated_back(outer.rotated(p)), p);
    expect_near(Vec3d{length(outer(p) - outer({})), 0, 0}, Vec3d{2.5 * length(p), 0, 0});
  }
}

}  // namespace
}  // namespace lodestone
