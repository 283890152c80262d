// Counts of the connectivity of surfaces.
#include <gtest/gtest.h>

#include "core/spherical/surface.h"
#include "tests/test_meshes.h"

namespace lodestone::spherical {
namespace {

Surface surface_from(const IndexedMesh& mesh) {
  Surface surface;
  for (const Vec3f p : mesh.positions) surface.positions.push_back(to_double(p));
  surface.triangles = mesh.triangles;
  return surface;
}

TEST(Surface, SphereIsOne) { EXPECT_TRUE(is_sphere(surface_from(test::sphere_mesh(3)))); }

TEST(Surface, EmptyIsNone) { EXPECT_FALSE(is_sphere(Surface{})); }

TEST(Surface, SheetHasABorder) {
  const IndexedMesh sheet = test::terrain_mesh(4);
  const SurfaceKind kind = kind_of(sheet.triangles, sheet.positions.size());
  EXPECT_EQ(kind, (SurfaceKind{.components = 1, .euler = 1, .open_edges = 16, .split_fans = 0}));
}

TEST(Surface, TurnedTriangleClashesWithItsNeighbours) {
  Surface surface = surface_from(test::sphere_mesh(1));
  std::swap(surface.triangles[0].v[1], surface.triangles[0].v[2]);
  const SurfaceKind kind = kind_of(surface.triangles, surface.positions.size());
  EXPECT_EQ(kind.open_edges, 3u);
  EXPECT_EQ(kind.euler, 2);
  EXPECT_FALSE(is_sphere(surface));
}

TEST(Surface, SpheresThatTouchInAVertexAreOneComponentWithASplitFan) {
  Surface surface = surface_from(test::sphere_mesh(1));
  const std::vector<Triangle> first = surface.triangles;
  const auto count = static_cast<std::uint32_t>(surface.positions.size());
  for (const auto& [v] : first) {
    const auto other = [&](std::uint32_t x) { return x == 0 ? 0 : x + count - 1; };
    surface.triangles.push_back({{other(v[0]), other(v[1]), other(v[2])}});
  }
  const SurfaceKind kind = kind_of(surface.triangles, 2 * count - 1);
  EXPECT_EQ(kind, (SurfaceKind{.components = 1, .euler = 3, .open_edges = 0, .split_fans = 1}));
}

TEST(Surface, DegenerateTrianglesAndUnusedVerticesAreCounted) {
  const std::vector<Triangle> triangles{{{0, 1, 2}}, {{2, 1, 0}}, {{0, 0, 1}}};
  const SurfaceKind kind = kind_of(triangles, 5);
  EXPECT_EQ(kind.degenerate, 1u);
  EXPECT_EQ(kind.unused, 2u);
  EXPECT_EQ(kind.euler, 2);
}

}  // namespace
}  // namespace lodestone::spherical
