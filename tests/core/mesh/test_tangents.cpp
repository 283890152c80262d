// Tangents: along u in the plane of the normal, with the side on which v falls.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/mesh/tangents.h"

namespace lodestone {
namespace {

struct Sheet {
  std::vector<Triangle> triangles;
  std::vector<Vec3f> positions, normals;
  std::vector<Vec2f> uv;
};

// A square that faces along z, u along x, v down along -y; `mirrored`: u along -x.
Sheet square(bool mirrored = false) {
  Sheet s;
  s.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  s.normals.assign(4, {0, 0, 1});
  s.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  for (const Vec3f p : s.positions) s.uv.push_back({mirrored ? 1 - p.x / 2 : p.x / 2, 1 - p.y / 2});
  return s;
}

std::vector<Tangent> tangents(const Sheet& s) { return tangents_of(s.triangles, s.positions, s.uv, s.normals); }

TEST(Tangents, LieAlongU) {
  for (const Tangent& t : tangents(square())) EXPECT_EQ(t, (Tangent{{1, 0, 0}, 1}));
  for (const Tangent& t : tangents(square(true))) EXPECT_EQ(t, (Tangent{{-1, 0, 0}, -1}));
}

// A cylinder around z, u around it and v down: tangents are known at every vertex.
TEST(Tangents, FollowACurvedSurface) {
  constexpr std::uint32_t around = 24, high = 6;
  Sheet s;
  for (std::uint32_t j = 0; j <= high; ++j)
    for (std::uint32_t i = 0; i <= around; ++i) {
      const double a = 2 * std::numbers::pi * i / around;
      const auto x = static_cast<float>(std::cos(a)), y = static_cast<float>(std::sin(a));
      s.positions.push_back({x, y, 1 - 0.3f * static_cast<float>(j)});
      s.normals.push_back({x, y, 0});
      s.uv.push_back({static_cast<float>(i) / around, static_cast<float>(j) / high});
    }
  for (std::uint32_t j = 0; j < high; ++j)
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t at = j * (around + 1) + i, below = at + around + 1;
      s.triangles.push_back({{at, below, below + 1}});
      s.triangles.push_back({{at, below + 1, at + 1}});
    }
  const std::vector<Tangent> found = tangents(s);
  for (std::size_t w = 0; w < found.size(); ++w) {
    EXPECT_LT(length(found[w].along_u - Vec3f{-s.normals[w].y, s.normals[w].x, 0}), 2e-3f);
    EXPECT_EQ(found[w].side, 1);
    EXPECT_EQ(found[w].along_u.x * 1024, std::floor(found[w].along_u.x * 1024));
  }
}

TEST(Tangents, AreOfUnitLengthWhereNothingTellsThem) {
  Sheet s = square();
  s.uv.assign(4, {0.5f, 0.5f});
  for (const Vec3f n : {Vec3f{1, 0, 0}, Vec3f{0, -1, 0}, Vec3f{0.6f, 0, 0.8f}}) {
    s.normals.assign(4, n);
    for (const Tangent& t : tangents(s)) {
      EXPECT_NEAR(length(t.along_u), 1, 1e-3);
      EXPECT_NEAR(dot(t.along_u, n), 0, 1e-3);
    }
  }
  s.normals.assign(4, {});
  for (const Tangent& t : tangents(s)) EXPECT_NEAR(length(t.along_u), 1, 1e-3);
}

}  // namespace
}  // namespace lodestone
