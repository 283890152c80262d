// Samples of the octahedral square and the triangles that contain them, against every triangle for every sample.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/spherical/octahedron/sphere_raster.h"
#include "tests/core/spherical/sphere_checks.h"

namespace lodestone::spherical {
namespace {

// The least product of a direction with the planes through the edges: not negative within.
double depth(const test::SphereMesh& mesh, std::uint32_t t, Vec3d d) {
  double least = 1;
  for (std::size_t k = 0; k < 3; ++k)
    least = std::min(least, dot(d, cross(mesh.directions[mesh.triangles[t].v[k]],
                                         mesh.directions[mesh.triangles[t].v[(k + 1) % 3]])));
  return least;
}

void expect_covers(const test::SphereMesh& mesh, SampleGrid grid) {
  SphereRaster raster(mesh.triangles, mesh.directions, grid),
      plain(mesh.triangles, mesh.directions, grid, InstructionSet::plain);
  raster.prepare();
  plain.prepare();
  SampleTile tile, other;
  std::size_t samples = 0;
  for (std::size_t k = 0; k < raster.tile_count(); ++k) {
    raster.cover(k, tile);
    plain.cover(k, other);
    EXPECT_EQ(tile.triangle, other.triangle);
    EXPECT_EQ(tile.ray, other.ray);
    for (std::uint32_t y = 0; y < tile.height; ++y)
      for (std::uint32_t x = 0; x < tile.width; ++x, ++samples) {
        const std::size_t i = std::size_t{y} * SampleTile::side + x;
        const Vec3d d = direction_of(grid.place(tile.x + x, tile.y + y));
        const Vec3d ray{tile.ray[0][i], tile.ray[1][i], tile.ray[2][i]};
        EXPECT_LT(length(d - (1 / length(ray)) * ray), 1e-15);
        for (const auto& component : {&tile.weight, &other.weight}) EXPECT_EQ((*component)[0][i], tile.weight[0][i]);
        ASSERT_NE(tile.triangle[i], no_triangle) << tile.x + x << ' ' << tile.y + y;
        ASSERT_GE(depth(mesh, tile.triangle[i], d), -1e-15);
        Vec3d along{};
        for (std::size_t c = 0; c < 3; ++c)
          along = along + double{tile.weight[c][i]} * mesh.directions[mesh.triangles[tile.triangle[i]].v[c]];
        ASSERT_LT(length((1 / length(along)) * along - d), 1e-6);
        // No other triangle has it deep inside.
        if (samples % 97 != 0) continue;
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
          ASSERT_TRUE(t == tile.triangle[i] || depth(mesh, t, d) <= 1e-15);
      }
  }
  EXPECT_EQ(samples, std::size_t{grid.n} * grid.n);
}

TEST(SphereRaster, EverySampleHasTheTriangleThatContainsIt) {
  test::Numbers number(11);
  for (int k = 0; k < 24; ++k) {
    test::SphereMesh mesh = k % 2 == 0 ? test::tetrahedron_on_sphere(k / 2 % 6) : test::octahedron_on_sphere(k / 2 % 5);
    if (k > 5) rotate(mesh, number.rotation());
    for (const std::uint32_t n : {1u, 63u, 64u, 150u}) expect_covers(mesh, {n, SampleGrid::Placing::in_cells});
    expect_covers(mesh, {129, SampleGrid::Placing::on_sides});
    expect_covers(mesh, {2, SampleGrid::Placing::on_sides});
  }
}

// Long thin triangles have boxes that must hold their bent images: a double fan of a hundred from pole to pole.
TEST(SphereRaster, LongNeedlesAreFound) {
  test::SphereMesh mesh;
  constexpr std::uint32_t n = 100;
  mesh.directions = {{0, 0, 1}, {0, 0, -1}};
  test::Numbers number(3);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * 3.141592653589793 * i / n, height = 0.9 * (number() - 0.5);
    const double r = std::sqrt(1 - height * height);
    mesh.directions.push_back({r * std::cos(angle), r * std::sin(angle), height});
    const std::uint32_t a = 2 + i, b = 2 + (i + 1) % n;
    mesh.triangles.push_back({{0, a, b}});
    mesh.triangles.push_back({{1, b, a}});
  }
  for (int k = 0; k < 10; ++k) {
    expect_covers(mesh, {200, SampleGrid::Placing::in_cells});
    rotate(mesh, number.rotation());
  }
}

TEST(SphereRaster, HolesAreToldFromTriangles) {
  test::SphereMesh mesh = test::octahedron_on_sphere(2);
  mesh.triangles.erase(mesh.triangles.begin() + 5);
  SphereRaster raster(mesh.triangles, mesh.directions, {64, SampleGrid::Placing::in_cells});
  raster.prepare();
  SampleTile tile;
  raster.cover(0, tile);
  const auto missing = std::ranges::count(tile.triangle, no_triangle);
  EXPECT_GT(missing, 64 * 64 / 128 / 2);
  EXPECT_LT(missing, 64 * 64 / 128 * 2);
}

}  // namespace
}  // namespace lodestone::spherical
