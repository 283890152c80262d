// Normal maps in tangent space give back the normals in object space that they were made from.
#include <gtest/gtest.h>

#include <cmath>

#include "core/spherical/resample/tangent_normals.h"
#include "tests/core/spherical/sphere_checks.h"

namespace lodestone::spherical {
namespace {

// A grid over the whole square, or the upper part of it, as a bulge with uneven normals.
struct Bulge {
  std::vector<Triangle> triangles;
  std::vector<Vec3f> positions, normals;
  std::vector<Vec2f> uv;
  std::vector<Tangent> tangents;

  explicit Bulge(float height = 1) {
    constexpr std::uint32_t n = 7;
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < n; ++i) {
        const float x = static_cast<float>(i) / (n - 1), y = static_cast<float>(j) / (n - 1);
        uv.push_back({x, height * y});
        positions.push_back({x, 1 - y, std::sin(3 * x) * std::sin(2 * y)});
        const Vec3f normal{0.4f * std::sin(5 * x), 0.5f * std::cos(4 * y), 1};
        normals.push_back((1 / length(normal)) * normal);
      }
    for (std::uint32_t j = 0; j + 1 < n; ++j)
      for (std::uint32_t i = 0; i + 1 < n; ++i) {
        const std::uint32_t at = j * n + i;
        triangles.push_back({{at, at + n, at + n + 1}});
        triangles.push_back({{at, at + n + 1, at + 1}});
      }
    tangents = tangents_of(triangles, positions, uv, normals);
  }
  [[nodiscard]] FramedMesh framed() const { return {triangles, uv, normals, tangents}; }
};

// Smooth, and the same in both directions along each side.
LinearImage smooth_normals(std::uint32_t n) {
  LinearImage image{{n, n}, 3, {}};
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const double a = (x + 0.5) / n - 0.5, b = (y + 0.5) / n - 0.5;
      const Vec3d v{0.5 * std::cos(3 * a), 0.6 * std::cos(4 * b) - 0.3, 1};
      for (const double c : {v.x, v.y, v.z}) image.values.push_back(static_cast<float>(c / length(v)));
    }
  return image;
}

TEST(TangentFrame, IsInvertedWhateverItsAxes) {
  test::Numbers number(3);
  for (int i = 0; i < 200; ++i) {
    const TangentFrame frame{number.direction(), number.direction(), number.direction()};
    if (std::abs(dot(frame.along_u, cross(frame.up, frame.normal))) < 0.05) continue;
    const Vec3d n = number.direction(), back = frame.to_object(frame.to_tangent(n));
    EXPECT_LT(length((1 / length(back)) * back - n), 1e-9);
  }
  EXPECT_EQ(TangentFrame{}.to_tangent({0, 0, 1}), Vec3d{});
}

TEST(TangentNormals, GiveBackNormalsInObjectSpace) {
  const Bulge bulge;
  const LinearImage object = smooth_normals(128);
  const LinearImage map = tangent_normals(bulge.framed(), object, 64);
  ASSERT_EQ(map.size, (PixelSize{64, 64}));
  double shown = 0, plain = 0;
  int points = 0;
  for (const Triangle& t : bulge.triangles)
    for (const auto& weight : {std::array{0.2, 0.3, 0.5}, std::array{1.0, 0.0, 0.0}, std::array{0.0, 0.5, 0.5}}) {
      shown += shown_angle(bulge.framed(), t, weight, map, object);
      plain += shown_angle(bulge.framed(), t, weight, {}, object);
      ++points;
    }
  EXPECT_LT(shown / points, 0.2);
  EXPECT_GT(plain / points, 10);
}

// At the sides, and at both copies of a point there, the normal is that of the object-space image.
TEST(TangentNormals, MeetAtTheCut) {
  const Bulge bulge;
  const LinearImage object = smooth_normals(64);
  const LinearImage map = tangent_normals(bulge.framed(), object, 32);
  const Triangle &first = bulge.triangles.front(), &last = bulge.triangles.back();
  EXPECT_LT(shown_angle(bulge.framed(), first, {1, 0, 0}, map, object), 0.05);
  EXPECT_LT(shown_angle(bulge.framed(), last, {0, 1, 0}, map, object), 0.05);
}

TEST(TangentNormals, PointOutOfTheSurfaceAndFillWhatIsEmpty) {
  const Bulge bulge(0.5f);
  LinearImage object{{32, 32}, 3, {}};
  for (int i = 0; i < 32 * 32; ++i) object.values.insert(object.values.end(), {0.6f, 0, -0.8f});
  const LinearImage map = tangent_normals(bulge.framed(), object, 16);
  for (std::size_t i = 0; i < map.values.size(); i += 3) {
    EXPECT_GE(map.values[i + 2], 0);
    EXPECT_GT(std::abs(map.values[i]) + std::abs(map.values[i + 1]), 0.5f) << i;  // below the bulge, too
  }
  const LinearImage empty = tangent_normals({{}, bulge.uv, bulge.normals, bulge.tangents}, object, 16);
  for (std::size_t i = 0; i < empty.values.size(); i += 3) EXPECT_EQ(empty.values[i + 2], 1);
}

}  // namespace
}  // namespace lodestone::spherical
