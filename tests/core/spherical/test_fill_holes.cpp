// Holes of any size are filled so that the surface is closed and no vertex has a large valence.
#include <gtest/gtest.h>

#include <cmath>

#include "core/spherical/topology/components.h"
#include "core/spherical/topology/fill_holes.h"
#include "core/spherical/topology/manifold.h"
#include "tests/test_meshes.h"

namespace lodestone::spherical {
namespace {

// A fan of n triangles: a disk whose border has n vertices.
Surface disk(Id n) {
  Surface surface;
  surface.positions.push_back({0, 0, 0});
  for (Id k = 0; k < n; ++k) {
    const double angle = 6.283185307179586 * k / n;
    surface.positions.push_back({std::cos(angle), std::sin(angle), 0.1 * std::cos(3 * angle)});
    surface.triangles.push_back({{0, k + 1, (k + 1) % n + 1}});
  }
  surface.source_vertex.assign(n + 1, 0);
  surface.source_triangle.assign(n, 0);
  return surface;
}

TEST(FillHoles, DisksOfAnySizeBecomeSpheres) {
  for (const Id n : {3u, 4u, 11u, 12u, 13u, 14u, 25u, 100u, 1001u, 9999u}) {
    Surface surface = disk(n);
    const FilledHoles filled = fill_holes(surface);
    EXPECT_EQ(filled.loops, 1u);
    EXPECT_EQ(filled.triangles, surface.triangles.size() - n);
    EXPECT_LE(filled.triangles, 4 * n);
    EXPECT_EQ(filled.triangles == n, n <= 12) << n;  // a fan without a ring
    EXPECT_TRUE(is_sphere(surface)) << n;
    EXPECT_EQ(surface.source_triangle.size(), surface.triangles.size());
    EXPECT_EQ(surface.source_vertex.size(), surface.positions.size());
    std::vector<int> valence(surface.positions.size());
    for (const auto& [v] : surface.triangles)
      for (const Id corner : v) ++valence[corner];
    for (Id v = 1; v < valence.size(); ++v) EXPECT_LE(valence[v], 12) << n;  // 0 is the disk's own centre
    for (std::size_t t = n; t < surface.triangles.size(); ++t) EXPECT_EQ(surface.source_triangle[t], no_source);
    for (std::size_t v = n + 1; v < surface.positions.size(); ++v) {
      EXPECT_EQ(surface.source_vertex[v], no_source);
      EXPECT_LT(length(surface.positions[v]), 1.01);
    }
  }
}

TEST(FillHoles, TrianglesOfAFlatFillAreWellShapedAndDoNotOverlap) {
  Surface surface = disk(400);
  for (Vec3d& p : surface.positions) p.z = 0;
  fill_holes(surface);
  double area = 0;
  for (std::size_t t = 400; t < surface.triangles.size(); ++t) {
    const auto& v = surface.triangles[t].v;
    const Vec3d a = surface.positions[v[0]], b = surface.positions[v[1]], c = surface.positions[v[2]];
    const double twice = cross(b - a, c - a).z;
    EXPECT_LT(twice, 0);  // it closes a disk that is seen from above
    const double edges = dot(b - a, b - a) + dot(c - b, c - b) + dot(a - c, a - c);
    EXPECT_GT(-2 * std::sqrt(3.0) * twice / edges, 0.4);  // 1: equilateral
    area -= 0.5 * twice;
  }
  EXPECT_NEAR(area, 3.14159, 1e-3);
}

TEST(FillHoles, EveryBorderOfASurfaceIsClosed) {
  IndexedMesh mesh = test::sphere_mesh(4);
  const std::size_t before = mesh.triangles.size();
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (t % 103 != 0) kept.push_back(mesh.triangles[t]);
  mesh.triangles = kept;
  Surface surface = make_manifold(mesh).surface;
  EXPECT_EQ(fill_holes(surface).loops, before - kept.size());
  EXPECT_TRUE(is_sphere(surface));
}

TEST(FillHoles, AClosedSurfaceRemainsAsItIs) {
  Surface surface = make_manifold(test::torus_mesh(7, 5)).surface;
  EXPECT_EQ(fill_holes(surface).triangles, 0u);
  EXPECT_EQ(surface.triangles, make_manifold(test::torus_mesh(7, 5)).surface.triangles);
}

TEST(Components, AreTakenApartInTheOrderOfTheirTriangles) {
  const IndexedMesh sphere = test::sphere_mesh(1);
  const auto count = static_cast<Id>(sphere.positions.size());
  Surface both;
  for (const Triangle& t : sphere.triangles) {  // one triangle of each in turn; the second has the lower numbers
    both.triangles.push_back({{t.v[0] + count, t.v[1] + count, t.v[2] + count}});
    both.triangles.push_back(t);
  }
  for (Id v = 0; v < 2 * count; ++v) {
    both.positions.push_back(to_double(sphere.positions[v % count]));
    both.source_vertex.push_back(v);
  }
  for (Id t = 0; t < both.triangles.size(); ++t) both.source_triangle.push_back(t);
  const std::vector<Surface> parts = split_components(both);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].source_vertex.front(), count);
  EXPECT_EQ(parts[1].source_vertex.front(), 0u);
  for (std::size_t part = 0; part < 2; ++part) {
    EXPECT_TRUE(is_sphere(parts[part]));
    EXPECT_EQ(parts[part].triangles, sphere.triangles);
    for (Id t = 0; t < sphere.triangles.size(); ++t) EXPECT_EQ(parts[part].source_triangle[t], 2 * t + part);
  }
  EXPECT_TRUE(split_components({}).empty());
}

}  // namespace
}  // namespace lodestone::spherical
