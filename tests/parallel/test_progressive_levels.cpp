// Levels of progressive meshes as meshes of their own: where their vertices are.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "core/hierarchy/model/level_mesh.h"
#include "core/mesh/generate.h"
#include "core/progressive/mesh/level.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/mesh/compare.h"
#include "parallel/progressive/make_progressive.h"
#include "tests/parallel/progressive_meshes.h"

namespace lodestone {
namespace {

const std::unique_ptr<Scheduler> scheduler = make_serial_scheduler();

IndexedMesh generated(Shape shape, std::uint64_t triangles) {
  Repairs repairs;
  return prepare_mesh(generate_mesh({.shape = shape, .triangles = triangles}), repairs, *scheduler);
}

ProgressiveMesh progressive_of(const IndexedMesh& mesh) {
  ProgressiveReport report;
  return make_progressive(mesh, {}, *scheduler, report);
}

// The larger of both directions.
double rms(const RawMesh& a, const RawMesh& b) {
  const MeshDistance distance = compare_meshes(a, b, {20'000}, *scheduler);
  return std::max(distance.forward.rms, distance.backward.rms);
}

// The slow twin: the same triangles on vertices of the input.
RawMesh unmoved(const ProgressiveMesh& mesh, RawMesh level) {
  for (std::size_t v = 0; v < level.positions.size(); ++v)
    level.positions[v] = mesh.transform.to_model(mesh.positions[v]);
  return level;
}

TEST(LevelPlacement, IsAsNearAsAHierarchyOfEqualCounts) {
  for (const Shape shape : {Shape::sphere, Shape::torus}) {
    const IndexedMesh mesh = generated(shape, 20'000);
    const ProgressiveMesh progressive = progressive_of(mesh);
    const LevelFinder levels(progressive);
    const RawMesh input = levels.level_mesh(progressive.vertex_count());
    BuildConfig config;
    config.cell_triangles = 400;
    const Hierarchy hierarchy = build_hierarchy(IndexedMesh(mesh), config, *scheduler);
    for (int l = hierarchy.finest() - 2; l < hierarchy.finest(); ++l) {
      const RawMesh built = level_mesh(hierarchy, l);
      const RawMesh level = levels.level_mesh(levels.vertices_for_triangles(built.triangles.size()));
      EXPECT_LE(rms(level, input), 1.1 * rms(built, input)) << built.triangles.size();
    }
  }
}

TEST(LevelPlacement, BeatsVerticesOfTheInput) {
  for (const Shape shape : {Shape::sphere, Shape::terrain}) {
    const ProgressiveMesh mesh = progressive_of(generated(shape, 20'000));
    const LevelFinder levels(mesh);
    const RawMesh input = levels.level_mesh(mesh.vertex_count());
    for (const std::size_t triangles : {300, 3'000}) {
      const RawMesh level = levels.level_mesh(levels.vertices_for_triangles(triangles));
      EXPECT_LT(rms(level, input), 0.9 * rms(unmoved(mesh, level), input)) << triangles;
    }
  }
}

// Squares of a cube are flat, and its edges are sharp.
TEST(LevelPlacement, KeepsWhatIsExact) {
  RawMesh cube;
  test::add_cube(
      12, [](Vec3d p) { return p; }, cube.positions, cube.triangles);
  Repairs repairs;
  const ProgressiveMesh mesh = progressive_of(prepare_mesh(std::move(cube), repairs, *scheduler));
  const LevelFinder levels(mesh);
  const RawMesh level = levels.level_mesh(levels.vertices_for_triangles(60));
  EXPECT_LT(rms(level, levels.level_mesh(mesh.vertex_count())), 1e-6);
}

TEST(LevelPlacement, BordersAndSeamsRemain) {
  const ProgressiveMesh terrain = progressive_of(generated(Shape::terrain, 5'000));
  const ProgressiveMesh torus = progressive_of(test::textured_torus(40, 30, false, *scheduler));
  for (const ProgressiveMesh* mesh : {&terrain, &torus}) {
    const LevelFinder levels(*mesh);
    const std::uint32_t vertices = levels.vertices_for_triangles(mesh->triangles.size() / 8);
    const RawMesh level = levels.level_mesh(vertices), before = unmoved(*mesh, level);
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> edges;  // of one triangle: on a border, or on a seam
    for (const Triangle& t : level.triangles)
      for (std::size_t k = 0; k < 3; ++k) edges.insert(std::minmax(t.v[k], t.v[(k + 1) % 3]));
    std::size_t checked = 0, moved = 0;
    for (const auto& edge : edges)
      if (edges.count(edge) == 1) {
        ++checked;
        for (const std::uint32_t v : {edge.first, edge.second}) EXPECT_EQ(level.positions[v], before.positions[v]);
      }
    for (std::uint32_t v = 0; v < vertices; ++v) moved += level.positions[v] != before.positions[v];
    EXPECT_GT(checked, 10u);
    EXPECT_GT(moved, vertices / 4);
  }
}

// Where the surface was cut apart, both sides have a vertex at the same place, before and after.
TEST(LevelPlacement, CopiesStayTogether) {
  const ProgressiveMesh mesh = progressive_of(test::touching_cubes(6, *scheduler));
  const LevelFinder levels(mesh);
  for (const std::size_t triangles : {100, 300}) {
    const RawMesh level = levels.level_mesh(levels.vertices_for_triangles(triangles)), before = unmoved(mesh, level);
    for (std::size_t a = 0; a < level.positions.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        if (before.positions[a] == before.positions[b]) EXPECT_EQ(level.positions[a], level.positions[b]);
  }
}

}  // namespace
}  // namespace lodestone
