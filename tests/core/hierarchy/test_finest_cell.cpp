// The small tools of a cell's packing against plain twins.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "core/hierarchy/build/cell_build.h"
#include "core/hierarchy/model/hierarchy.h"
#include "core/hierarchy/model/vertex_numbers.h"

namespace lodestone {
namespace {

std::vector<Triangle> random_triangles(std::size_t count, std::uint32_t ids, std::mt19937& random) {
  std::vector<Triangle> triangles(count);
  for (Triangle& t : triangles)
    for (std::uint32_t& v : t.v) v = static_cast<std::uint32_t>(random() % ids * 0x0101'0101u % 0x7fff'ffffu);
  return triangles;
}

TEST(VertexNumbers, FollowTheOrderOfAppearance) {
  std::mt19937 random(1);
  VertexNumbers numbers;
  for (const std::size_t count : {0u, 1u, 2u, 100u, 5000u, 3u}) {
    for (const std::uint32_t ids : {3u, 1000u, 1'000'000u}) {  // the last: a soup, for which the table must grow
      const std::vector<Triangle> triangles = random_triangles(count, ids, random);
      std::vector<Triangle> numbered(count);
      numbers.clear(count);
      const std::size_t half = count / 2;
      numbers.number(std::span(triangles).first(half), numbered.data());
      numbers.number(std::span(triangles).subspan(half), numbered.data() + half);
      std::map<std::uint32_t, std::uint32_t> twin;
      for (std::size_t t = 0; t < count; ++t)
        for (std::size_t k = 0; k < 3; ++k) {
          const auto next = static_cast<std::uint32_t>(twin.size());
          ASSERT_EQ(numbered[t].v[k], twin.try_emplace(triangles[t].v[k], next).first->second);
        }
      ASSERT_EQ(numbers.vertices().size(), twin.size());
      for (const auto& [id, number] : twin) EXPECT_EQ(numbers.vertices()[number], id);
    }
  }
}

TEST(VertexNumbers, MayReplaceTheIdsInPlace) {
  std::mt19937 random(2);
  std::vector<Triangle> triangles = random_triangles(500, 300, random);
  const std::vector<Triangle> before = triangles;
  VertexNumbers numbers;
  numbers.clear(0);  // too small on purpose
  numbers.number(triangles, triangles.data());
  for (std::size_t t = 0; t < before.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(numbers.vertices()[triangles[t].v[k]], before[t].v[k]);
}

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
