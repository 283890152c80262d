// The builder's measure of distance against brute force over all triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "core/hierarchy/construct/star_distance.h"
#include "core/simplify/simplifiers.h"
#include "core/spatial/point_triangle.h"
#include "tests/hard_mesh.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

double brute_force(const std::vector<Triangle>& triangles, const std::vector<Vec3f>& positions, Vec3f p) {
  double nearest = 1e300;
  for (const Triangle& t : triangles) {
    if (is_degenerate(t)) continue;
    nearest = std::min(nearest, nearest_on_triangle(to_double(p), to_double(positions[t.v[0]]),
                                                    to_double(positions[t.v[1]]), to_double(positions[t.v[2]]))
                                    .squared_distance);
  }
  return nearest;
}

class StarDistanceOf : public testing::TestWithParam<IndexedMesh (*)()> {};

TEST_P(StarDistanceOf, SimplifiedMeshIsTheDistanceOfItsSurface) {
  const IndexedMesh mesh = GetParam()();
  const std::vector<std::uint8_t> locked(mesh.positions.size(), 0);
  const auto simplifier = make_simplifier("quadric");
  const SimplifyResult& result =
      simplifier->simplify({mesh.positions, mesh.triangles, locked, 0.2f, mesh.triangles.size() / 4});
  std::vector<Triangle> images;
  for (const auto& [v] : mesh.triangles)
    images.push_back({{result.parent[v[0]], result.parent[v[1]], result.parent[v[2]]}});

  StarDistance surface;
  surface.reset(images, result.positions);
  double largest = 0, largest_exact = 0, running = 0;
  std::size_t exact_ones = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double exact = brute_force(images, result.positions, mesh.positions[v]);
    const double measured = surface.farther(0, mesh.positions[v], VertexId(result.parent[v]));
    EXPECT_GE(measured, exact * (1 - 1e-9)) << "never less than the distance";
    exact_ones += measured <= exact * (1 + 1e-9) + 1e-20;
    largest = std::max(largest, measured);
    largest_exact = std::max(largest_exact, exact);
    running = surface.farther(running, mesh.positions[v], VertexId(result.parent[v]));
  }
  EXPECT_GT(static_cast<double>(exact_ones), 0.99 * static_cast<double>(mesh.positions.size()));
  EXPECT_LT(std::sqrt(largest), 1.5 * std::sqrt(largest_exact));
  // The glance in single precision may end a query early only within the running maximum.
  EXPECT_NEAR(std::sqrt(running), std::sqrt(largest), 1e-3 * std::sqrt(largest));
}

INSTANTIATE_TEST_SUITE_P(Meshes, StarDistanceOf,
                         testing::Values([] { return test::sphere_mesh(4); }, [] { return test::terrain_mesh(40); },
                                         [] { return test::torus_mesh(60, 30); }),
                         [](const auto& param) { return std::to_string(param.index); });

// Each vertex of the rim moves into the hub, in whose star all triangles are: quadratic time would be a minute.
TEST(StarDistance, OfAHubWithManyTrianglesIsExactAndQuick) {
  const RawMesh wheel = test::hard_mesh(hard_case("wheel"), 50'000);
  std::vector<Vec3f> positions;
  for (const Vec3d p : wheel.positions) positions.push_back(to_float(p));
  const std::clock_t begin = std::clock();
  StarDistance surface;
  surface.reset(wheel.triangles, positions);
  for (std::uint32_t v = 1; v < positions.size(); ++v) {
    const Vec3f p = positions[v] + Vec3f{0, 0, 1e-4f};
    const double measured = surface.farther(0, p, VertexId(0));
    ASSERT_LE(measured, 1.01e-4 * 1.01e-4) << v;
    if (v % 10'000 == 0) {
      ASSERT_NEAR(measured, brute_force(wheel.triangles, positions, p), 1e-15) << v;
    }
  }
  EXPECT_LT(std::clock() - begin, 10 * CLOCKS_PER_SEC);
}

TEST(StarDistance, OfAVertexWithoutTrianglesIsTheWayToIt) {
  const std::vector<Vec3f> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5f, 0.5f, 0.5f}};
  const std::vector<Triangle> triangles{{{0, 1, 2}}, {{3, 3, 0}}};
  StarDistance surface;
  surface.reset(triangles, positions);
  EXPECT_DOUBLE_EQ(surface.farther(0, {0.5f, 0.5f, 1}, VertexId(3)), 0.25);
  EXPECT_DOUBLE_EQ(surface.farther(0, {0.25f, 0.25f, 0.5f}, VertexId(1)), 0.25);
  EXPECT_DOUBLE_EQ(surface.farther(1, {0.25f, 0.25f, 0.5f}, VertexId(1)), 1);
}

}  // namespace
}  // namespace lodestone
