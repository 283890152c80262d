// Closest points by Embree and by both of the project's own structures: the same distances.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "bench/embree_points.h"
#include "core/distance/triangle_bvh.h"
#include "core/hierarchy/level_surface.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

class EmbreePointsOf : public testing::TestWithParam<IndexedMesh (*)()> {};

TEST_P(EmbreePointsOf, AMeshAreThoseOfTheOwnStructures) {
  const IndexedMesh mesh = GetParam()();
  std::vector<Vec3d> positions;
  for (const Vec3f p : mesh.positions) positions.push_back(to_double(p));
  Hierarchy hierarchy;
  hierarchy.levels.resize(1);
  hierarchy.levels[0].cell_count = 1;
  hierarchy.cells.resize(1);
  hierarchy.cells[0].positions = mesh.positions;
  hierarchy.cells[0].triangles = mesh.triangles;
  LevelSurface surface(hierarchy, 0);
  surface.build_cell(0);
  surface.build_rest();
  const TriangleBvh bvh(positions, mesh.triangles);
  const EmbreePoints embree(positions, mesh.triangles);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> anywhere(-0.1, 1.1), near(-0.003, 0.003);
  std::uint32_t hint = 0;
  SurfaceItem item;
  for (int i = 0; i < 4000; ++i) {
    Vec3d p{anywhere(random), anywhere(random), anywhere(random)};
    if (i % 4 != 0)
      p = positions[random() % positions.size()] + Vec3d{near(random), near(random), near(random)};
    const double expected = std::sqrt(embree.nearest(p, hint));
    const LevelSurface::Nearest nearest = surface.nearest(p, item);
    item = nearest.item;
    EXPECT_NEAR(std::sqrt(nearest.squared_distance), expected, 1e-14);
    EXPECT_NEAR(std::sqrt(bvh.nearest(p).squared_distance), expected, 1e-14);
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, EmbreePointsOf,
                         testing::Values([] { return test::sphere_mesh(5); }, [] { return test::terrain_mesh(60); },
                                         [] { return test::torus_mesh(90, 40); }),
                         [](const auto& param) { return std::to_string(param.index); });

}  // namespace
}  // namespace lodestone
