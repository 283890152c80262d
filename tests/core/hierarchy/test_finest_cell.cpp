// The small tools of a cell's packing against plain twins.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/hierarchy/construct/cell_build.h"
#include "core/hierarchy/model/hierarchy.h"
#include "core/hierarchy/model/pack_normals.h"

namespace lodestone {
namespace {

// Normals of all kinds: random ones, axes, diagonals, zeros of both signs, tiny, huge, not finite.
std::vector<Vec3f> normals_of_all_kinds() {
  std::mt19937 random(3);
  std::normal_distribution<float> gauss;
  std::vector<Vec3f> normals;
  for (int i = 0; i < 2000; ++i) normals.push_back({gauss(random), gauss(random), gauss(random)});
  constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const float parts[] = {0, -0.0f, 1, -1, 0.5f, 1e-30f, -1e-42f, 3e38f, inf, -inf, nan};
  for (const float x : parts)
    for (const float y : parts)
      for (const float z : parts) normals.push_back({x, y, z});
  return normals;
}

TEST(PackNormals, GivesTheBitsOfPackNormal) {
  const std::vector<Vec3f> normals = normals_of_all_kinds();
  std::vector<Float4> padded;
  for (const Vec3f& n : normals) padded.push_back(to_float4(n));
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{6}, padded.size()}) {
    std::vector<PackedNormal> packed(count);
    pack_normals(std::span(padded).first(count), packed);
    for (std::size_t i = 0; i < count; ++i)
      EXPECT_EQ(packed[i], pack_normal(normals[i])) << normals[i].x << ' ' << normals[i].y << ' ' << normals[i].z;
  }
}

TEST(PackNormal, IsWithinItsErrorAndSafe) {
  for (const Vec3f n : normals_of_all_kinds()) {
    const Vec3f back = unpack_normal(pack_normal(n));
    EXPECT_NEAR(length(back), 1, 1e-5f);
    const double size = length(to_double(n));
    if (!(size > 1e-20 && size < 1e30)) continue;
    EXPECT_GT(dot(to_double(back), to_double(n)), 0);
    EXPECT_LT(length(cross(to_double(back), to_double(n))) / size, std::sin(0.004 * 3.1416 / 180));
  }
  EXPECT_EQ(pack_normal({}), PackedNormal{});
}

TEST(EdgeLengths, CountsAndMeasuresAsPlainDotProductsDo) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto point = [&] { return Vec3f{unit(random), unit(random), unit(random)}; };
  EdgeLengths lengths(0.7f);
  float longest2 = 0;
  std::uint64_t over = 0;
  EXPECT_EQ(lengths.longest2(), 0);
  for (int t = 0; t < 1000; ++t) {
    const Vec3f p[3] = {point(), point(), point()};
    for (int k = 0; k < 3; ++k) {
      const Vec3f edge = p[(k + 1) % 3] - p[k];
      longest2 = std::max(longest2, dot(edge, edge));
      over += dot(edge, edge) > 0.7f * 0.7f;
    }
    const Float4 a = to_float4(p[0]), b = to_float4(p[1]), c = to_float4(p[2]);
    lengths.add(b - a, c - b, c - a);
    EXPECT_EQ(to_vec3f(yzx(cross_zxy(b - a, c - a))), cross(p[1] - p[0], p[2] - p[0]));
  }
  EXPECT_EQ(lengths.longest2(), longest2);
  EXPECT_EQ(lengths.over(), over);
  EXPECT_GT(over, 100u);
}

}  // namespace
}  // namespace lodestone
