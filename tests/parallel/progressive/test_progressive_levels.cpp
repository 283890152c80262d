// Levels of progressive meshes as meshes of their own: where their vertices are, and how far they are from the input.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/hierarchy/model/level_mesh.h"
#include "core/mesh/generate.h"
#include "core/progressive/mesh/level.h"
#include "core/progressive/progressive_file.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/mesh/compare.h"
#include "parallel/progressive/level_errors.h"
#include "parallel/progressive/make_progressive.h"
#include "tests/parallel/progressive/progressive_meshes.h"

namespace lodestone {
namespace {

using test::progressive_of;

const std::unique_ptr<Scheduler> scheduler = make_serial_scheduler();

IndexedMesh generated(Shape shape, std::uint64_t triangles) {
  Repairs repairs;
  return prepare_mesh(generate_mesh({.shape = shape, .triangles = triangles}), repairs, *scheduler);
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

// Texture coordinates stay with their vertices: a texture would slide.
TEST(LevelPlacement, VerticesWithAttributesMoveAlongTheirNormals) {
  const ProgressiveMesh mesh = progressive_of(test::textured_torus(40, 30, false, *scheduler));
  const LevelFinder levels(mesh);
  const RawMesh level = levels.level_mesh(levels.vertices_for_triangles(mesh.triangles.size() / 4)),
                before = unmoved(mesh, level);
  std::vector<Vec3d> normals(level.positions.size());
  for (const Triangle& t : before.triangles) {
    const auto p = [&](std::size_t k) { return before.positions[t.v[k]]; };
    for (const std::uint32_t v : t.v) normals[v] = normals[v] + cross(p(1) - p(0), p(2) - p(0));
  }
  double way = 0, sideways = 0;
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const Vec3d moved = level.positions[v] - before.positions[v];
    way += length(moved);
    sideways += length(cross(moved, normals[v])) / length(normals[v]);
  }
  EXPECT_GT(way, 0);
  EXPECT_LT(sideways, 0.1 * way);
}

// Where the surface was cut apart, both sides have a vertex at the same place, before and after.
TEST(LevelPlacement, CopiesStayTogether) {
  const ProgressiveMesh mesh = progressive_of(test::touching_cubes(6, *scheduler));
  const LevelFinder levels(mesh);
  for (const std::size_t triangles : {100, 300}) {
    const RawMesh level = levels.level_mesh(levels.vertices_for_triangles(triangles)), before = unmoved(mesh, level);
    for (std::size_t a = 0; a < level.positions.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        if (before.positions[a] == before.positions[b]) {
          EXPECT_EQ(level.positions[a], level.positions[b]);
        }
  }
}

// Triangles on edges of the surface are cut off, and do not collapse: coarse levels are for the surface.
TEST(Flaps, AreOnlyInLevelsFinerThanThey) {
  RawMesh raw = test::raw_of(test::sphere_mesh(5));
  const std::size_t surface = raw.triangles.size();
  Repairs repairs;
  const ProgressiveMesh plain = progressive_of(prepare_mesh(RawMesh(raw), repairs, *scheduler));
  for (std::size_t t = 0; t + 2 < surface; t += 20)
    raw.triangles.push_back({{raw.triangles[t].v[0], raw.triangles[t].v[1], raw.triangles[t + 2].v[2]}});
  const std::size_t all = raw.triangles.size();
  const ProgressiveMesh mesh = progressive_of(prepare_mesh(std::move(raw), repairs, *scheduler));
  const LevelFinder levels(mesh);
  EXPECT_EQ(levels.compute_level(mesh.vertex_count()).size(), all);
  ASSERT_GT(all - surface, 300u);
  const std::uint32_t vertices = levels.vertices_for_triangles(150);
  EXPECT_GT(levels.triangles_of(vertices), 140u);
  const LevelFinder plain_levels(plain);
  const RawMesh level = levels.level_mesh(vertices);
  const RawMesh without = plain_levels.level_mesh(plain_levels.vertices_for_triangles(150));
  const RawMesh bare = plain_levels.level_mesh(plain.vertex_count());
  EXPECT_LT(rms(level, bare), 1.5 * rms(without, bare));
}

// The mesh as a reader gets it from a file of this name.
ProgressiveMesh written(const ProgressiveMesh& mesh, const std::string& name) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  (void)save_progressive(mesh, path);
  ProgressiveMesh read = load_progressive(path);
  std::filesystem::remove(path);
  return read;
}

// Points of both surfaces are the slow twin of the bound.
TEST(LevelErrors, HoldForEveryMetricAndQuantization) {
  const IndexedMesh torus = test::textured_torus(32, 24, true, *scheduler);
  for (const auto metric : {progressive::MetricKind::quadric, progressive::MetricKind::attribute_quadric,
                            progressive::MetricKind::parametric})
    for (const char* name : {"level_errors.lpm", "level_errors.glb"}) {
      ProgressiveReport report;
      const ProgressiveMesh all = make_progressive(torus, {.metric = metric}, *scheduler, report);
      const RawMesh input = LevelFinder(all).level_mesh(all.vertex_count());
      const ProgressiveMesh mesh = written(all, name);
      const LevelFinder levels(mesh);
      const LevelErrors errors(mesh, levels, *scheduler);
      for (const double error : {0.01, 0.04}) {
        const std::uint32_t vertices = errors.vertices_for(error);
        const MeshDistance distance = compare_meshes(levels.level_mesh(vertices), input, {}, *scheduler);
        const double sampled = std::max(distance.forward.max, distance.backward.max) / mesh.transform.scale;
        EXPECT_LE(sampled, error) << name << ", " << name_of(metric);
        EXPECT_GE(sampled, error / 3) << name << ", " << name_of(metric);
        EXPECT_LE(sampled, errors.error_of(vertices) * (1 + 1e-6) + 1e-12);
        EXPECT_LE(errors.error_of(vertices), 1.06 * error);
        EXPECT_LT(vertices, mesh.vertex_count());
      }
      EXPECT_EQ(errors.vertices_for(0), mesh.vertex_count());
      EXPECT_EQ(errors.vertices_for(1), mesh.base_vertices);
    }
}

TEST(LevelErrors, CountQuantizationAndWhatWasLeftOut) {
  const IndexedMesh sphere = generated(Shape::sphere, 3'000);
  ProgressiveReport report;
  const ProgressiveMesh fewer = make_progressive(sphere, {.finest_triangles = 1'000}, *scheduler, report);
  const ProgressiveMesh all = progressive_of(sphere);
  const RawMesh input = LevelFinder(all).level_mesh(all.vertex_count());
  EXPECT_EQ(all.finest_error, 0);
  EXPECT_EQ(written(all, "finest.glb").finest_error, 0);
  for (const ProgressiveMesh& mesh : {written(all, "finest.lpm"), written(fewer, "finest.lpm"), fewer}) {
    const MeshDistance distance =
        compare_meshes(LevelFinder(mesh).level_mesh(mesh.vertex_count()), input, {}, *scheduler);
    const double sampled = std::max(distance.forward.max, distance.backward.max) / mesh.transform.scale;
    EXPECT_GT(sampled, 1e-5);
    EXPECT_LE(sampled, mesh.finest_error);
    EXPECT_LE(mesh.finest_error, 2.5 * sampled);
  }
  EXPECT_NEAR(written(fewer, "finest.glb").finest_error, fewer.finest_error, 1e-12);
}

TEST(LevelErrors, AreTheSameForAnyNumberOfThreads) {
  const ProgressiveMesh mesh = progressive_of(generated(Shape::terrain, 6'000));
  const LevelFinder levels(mesh);
  const LevelErrors expected(mesh, levels, *scheduler);
  for (const int threads : {2, 5}) {
    const auto workers = make_tbb_scheduler(threads);
    const LevelErrors errors(mesh, levels, *workers);
    EXPECT_EQ(errors.error_of(500), expected.error_of(500));
    EXPECT_EQ(errors.vertices_for(0.01), expected.vertices_for(0.01));
  }
}

}  // namespace
}  // namespace lodestone
