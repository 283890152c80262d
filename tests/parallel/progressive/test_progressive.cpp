// Progressive meshes: what is promised of them on sound, open, seamed, cut and broken surfaces, for any number of
// threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/base/error.h"
#include "core/progressive/collapse/uv_star.h"
#include "core/progressive/mesh/activation.h"
#include "core/progressive/mesh/level.h"
#include "parallel/mesh/load.h"
#include "parallel/progressive/make_progressive.h"
#include "parallel/progressive/merge_records.h"
#include "tests/core/progressive/progressive_checks.h"
#include "tests/parallel/progressive/progressive_meshes.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

using progressive::MetricKind;
using test::some_levels;

ProgressiveMesh make(const IndexedMesh& mesh, ProgressiveConfig config = {}, ProgressiveReport* report = nullptr,
                     int threads = 1) {
  const auto scheduler = make_tbb_scheduler(threads);
  ProgressiveReport own;
  return make_progressive(mesh, config, *scheduler, report != nullptr ? *report : own);
}

std::vector<MetricKind> metrics_of(const IndexedMesh& mesh) {
  std::vector<MetricKind> metrics{MetricKind::quadric, MetricKind::attribute_quadric};
  if (!mesh.wedges.uv.empty()) metrics.push_back(MetricKind::parametric);
  return metrics;
}

// Everything at twenty levels: what is computed is what is defined, closed, and sound.
void expect_sound_levels(const ProgressiveMesh& mesh, std::size_t open_in_input) {
  const LevelFinder finder(mesh);
  for (const std::uint32_t level : some_levels(mesh, 20)) {
    const std::vector<Triangle> triangles = test::obvious_level(mesh, level);
    ASSERT_EQ(finder.vertices_for(level), level);
    ASSERT_EQ(finder.compute_level(level), triangles) << level;
    ASSERT_EQ(finder.triangles_of(level), triangles.size());
    ASSERT_EQ(test::bad_edges(mesh, triangles), 0u) << level;
    if (open_in_input == 0) {
      ASSERT_EQ(test::open_edges(mesh, triangles), 0u) << level;
    }
  }
}

TEST(ProgressiveMesh, ClosedSurfacesStayClosedAtEveryLevel) {
  for (const IndexedMesh& mesh : {test::sphere_mesh(5), test::torus_mesh(60, 40)})
    for (const std::size_t base : {std::size_t{0}, std::size_t{200}}) {
      const ProgressiveMesh out = make(mesh, {.base_triangles = base});
      EXPECT_EQ(test::progressive_mistake(out, mesh), "");
      expect_sound_levels(out, 0);
      const std::size_t left = LevelFinder(out).triangles_of(out.base_vertices);
      EXPECT_LE(left, base == 0 ? 40u : base + 1);
      EXPECT_GE(left, base);
    }
}

TEST(ProgressiveMesh, EveryPrefixOfAClosedSurfaceIsClosed) {
  const auto scheduler = make_tbb_scheduler(1);
  for (const IndexedMesh& mesh : {test::sphere_mesh(3), test::textured_torus(16, 12, true, *scheduler)}) {
    const ProgressiveMesh out = make(mesh);
    const LevelFinder finder(out);
    for (std::uint32_t level = out.base_vertices; level <= out.vertex_count(); ++level) {
      if (finder.vertices_for(level) != level) continue;  // would split a vertex
      const std::vector<Triangle> triangles = finder.compute_level(level);
      ASSERT_EQ(test::open_edges(out, triangles), 0u) << level;
      ASSERT_EQ(test::bad_edges(out, triangles), 0u) << level;
    }
  }
}

// Down to the base and up again through the same levels, each from the level before by what came in since: bit for bit
// the input in the end.
TEST(ProgressiveMesh, CoarsenedAndRefinedItIsTheInput) {
  const auto scheduler = make_tbb_scheduler(1);
  for (const IndexedMesh& mesh :
       {test::sphere_mesh(4), test::terrain_mesh(25), test::textured_torus(24, 18, true, *scheduler)}) {
    const ProgressiveMesh out = make(mesh);
    const LevelFinder finder(out);
    const std::vector<std::uint32_t> levels = some_levels(out, 12);
    std::vector<std::vector<Triangle>> down;
    std::vector<Triangle> now = out.triangles;
    const std::vector<std::uint32_t> group = test::obvious_groups(out);
    for (std::size_t k = levels.size(); k-- > 0;) {
      for (Triangle& t : now)
        for (std::uint32_t& v : t.v) v = test::obvious_ancestor(out, v, levels[k]);
      std::erase_if(now, [&](const Triangle& t) {
        return is_degenerate(Triangle{group[t.v[0]], group[t.v[1]], group[t.v[2]]});
      });
      down.push_back(now);
    }
    for (std::size_t k = 0; k < levels.size(); ++k)
      EXPECT_EQ(finder.compute_level(levels[k]), down[levels.size() - 1 - k]);
    ProgressiveMesh finest = out;
    finest.triangles = finder.compute_level(out.vertex_count());
    EXPECT_EQ(test::triangle_values(finest), test::triangle_values(mesh));
  }
}

TEST(ProgressiveMesh, SameBytesOnEveryInstructionSet) {
  if (!is_available(InstructionSet::avx2)) GTEST_SKIP() << "no AVX2 here";
  const auto scheduler = make_tbb_scheduler(1);
  for (const IndexedMesh& mesh : {test::sphere_mesh(6), test::terrain_mesh(60), test::touching_cubes(8, *scheduler),
                                  test::textured_torus(48, 32, true, *scheduler)})
    for (const MetricKind metric : metrics_of(mesh)) {
      const ProgressiveMesh plain = make(mesh, {.metric = metric, .instructions = InstructionSet::plain});
      const ProgressiveMesh avx2 = make(mesh, {.metric = metric, .instructions = InstructionSet::avx2});
      EXPECT_EQ(plain.positions, avx2.positions);
      EXPECT_EQ(plain.parents, avx2.parents);
      EXPECT_EQ(plain.errors, avx2.errors);
      EXPECT_EQ(plain.triangles, avx2.triangles);
    }
}

// Triangles are ordered by the numbers of the input; the numbers of the result must say the same.
TEST(ProgressiveMesh, TrianglesComeInAsTheParentsSay) {
  for (const ProgressiveMesh& mesh : test::some_progressive_meshes()) {
    ProgressiveMesh sorted = mesh;
    progressive::sort_by_activation(sorted);
    EXPECT_EQ(sorted.triangles, mesh.triangles);
  }
}

TEST(MergeRecords, IsAStableSort) {
  std::mt19937 random(6);
  for (const std::size_t parts_count : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{60}}) {
    std::vector<std::vector<progressive::CollapseRecord>> parts(parts_count);
    std::vector<progressive::CollapseRecord> expected, merged(3);
    for (auto& part : parts) {
      float order = 0;
      for (std::size_t k = random() % 3000; k-- > 0;) {
        order += static_cast<float>(random() % 3) / 8;
        part.push_back({.vertex = static_cast<progressive::Id>(random()), .triangles = 2, .order = order});
      }
      expected.insert(expected.end(), part.begin(), part.end());
    }
    std::stable_sort(expected.begin(), expected.end(), [](auto& a, auto& b) { return a.order < b.order; });
    merge_records(parts, merged, *make_tbb_scheduler(2));
    ASSERT_EQ(merged.size(), expected.size() + 3);
    for (std::size_t k = 0; k < expected.size(); ++k) ASSERT_EQ(merged[k + 3].vertex, expected[k].vertex);
  }
}

TEST(ProgressiveMesh, BordersStayBorders) {
  const IndexedMesh mesh = test::terrain_mesh(50);
  const ProgressiveMesh out = make(mesh);
  EXPECT_EQ(test::progressive_mistake(out, mesh), "");
  expect_sound_levels(out, 200);
  // The corners of the square remain within a few of its squares.
  const auto level = some_levels(out, 20)[2];
  Vec3f lo{1, 1, 1}, hi{};
  for (std::uint32_t v = 0; v < level; ++v) {
    lo = {std::min(lo.x, out.positions[v].x), std::min(lo.y, out.positions[v].y), 0};
    hi = {std::max(hi.x, out.positions[v].x), std::max(hi.y, out.positions[v].y), 0};
  }
  EXPECT_LT(std::max(lo.x, lo.y), 0.05f);
  EXPECT_GT(std::min(hi.x, hi.y), 0.95f);
}

TEST(ProgressiveMesh, SeamsNeverOpenAndChartsStay) {
  const auto scheduler = make_tbb_scheduler(2);
  for (const bool halves : {false, true})
    for (const MetricKind metric : {MetricKind::quadric, MetricKind::attribute_quadric, MetricKind::parametric}) {
      const IndexedMesh mesh = test::textured_torus(48, 32, halves, *scheduler);
      const ProgressiveMesh out = make(mesh, {.metric = metric});
      EXPECT_EQ(test::progressive_mistake(out, mesh), "");
      expect_sound_levels(out, 0);
      // No triangle of any level reaches from one chart to the other, or across a seam.
      for (const std::uint32_t level : some_levels(out, 20))
        for (const Triangle& t : LevelFinder(out).compute_level(level))
          for (std::size_t k = 0; k < 3; ++k) {
            const Vec2f a = out.wedges.uv[t.v[k]], b = out.wedges.uv[t.v[(k + 1) % 3]];
            ASSERT_EQ(a.x > 1.5f, b.x > 1.5f);
          }
    }
}

// Metrics that know the texture turn over no triangle on it, at any level.
TEST(ProgressiveMesh, NoTriangleIsFoldedOnTheTexture) {
  const auto scheduler = make_tbb_scheduler(2);
  const IndexedMesh mesh = test::textured_torus(60, 40, true, *scheduler);
  for (const MetricKind metric : {MetricKind::attribute_quadric, MetricKind::parametric}) {
    const ProgressiveMesh out = make(mesh, {.metric = metric});
    for (const std::uint32_t level : some_levels(out, 30))
      for (const Triangle& t : LevelFinder(out).compute_level(level)) {
        const auto uv = [&](std::size_t k) { return out.wedges.uv[t.v[k]]; };
        ASSERT_GT(progressive::uv_area(uv(0), uv(1), uv(2)), 0) << level;
      }
  }
}

TEST(ProgressiveMesh, GeomorphsFollowAncestors) {
  const ProgressiveMesh out = make(test::sphere_mesh(4));
  const LevelFinder finder(out);
  const std::vector<std::uint32_t> levels = some_levels(out, 5);
  for (const std::uint32_t coarse : levels)
    for (const std::uint32_t fine : levels) {
      if (coarse > fine) continue;
      const std::vector<std::uint32_t> morph = finder.compute_geomorph(coarse, fine);
      ASSERT_EQ(morph.size(), fine);
      for (std::uint32_t v = 0; v < fine; ++v) ASSERT_EQ(morph[v], test::obvious_ancestor(out, v, coarse));
    }
}

TEST(ProgressiveMesh, LevelsByTrianglesAndByError) {
  const ProgressiveMesh out = make(test::sphere_mesh(5));
  const LevelFinder finder(out);
  for (const std::size_t wanted : {100u, 999u, 1000u, 5001u}) {
    const std::uint32_t level = finder.vertices_for_triangles(wanted);
    EXPECT_LE(finder.triangles_of(level), wanted);
    EXPECT_GE(finder.triangles_of(level) + 2, wanted);
  }
  EXPECT_EQ(finder.vertices_for_triangles(1), out.base_vertices);
  EXPECT_EQ(finder.vertices_for_triangles(1'000'000), out.vertex_count());
  for (const float error : {1e-1f, 1e-2f, 1e-3f}) {
    const std::uint32_t level = finder.vertices_for_error(error);
    EXPECT_TRUE(finder.error_of(level) <= error || level == out.vertex_count());
    EXPECT_TRUE(level == out.base_vertices || finder.error_of(level - 1) > error);
  }
  EXPECT_EQ(finder.error_of(out.vertex_count()), 0);
  EXPECT_EQ(finder.vertices_for_error(0),
            out.vertex_count() - static_cast<std::uint32_t>(std::count(out.errors.begin(), out.errors.end(), 0.0f)));
}

TEST(ProgressiveMesh, AFinestLevelOfFewerTriangles) {
  const auto scheduler = make_serial_scheduler();
  for (const IndexedMesh& input :
       {test::textured_torus(40, 30, true, *scheduler), test::touching_cubes(6, *scheduler)}) {
    ProgressiveReport report;
    const std::size_t all = input.triangles.size();
    EXPECT_EQ(make_progressive(input, {.finest_triangles = all}, *scheduler, report).triangles.size(), all);
    EXPECT_EQ(report.finest_error, 0);
    const ProgressiveMesh fewer = make_progressive(input, {.finest_triangles = all / 3}, *scheduler, report);
    check_progressive(fewer, "fewer");
    expect_sound_levels(fewer, 0);
    EXPECT_EQ(report.input_triangles, all);
    EXPECT_GE(fewer.triangles.size(), all / 3 - 1);
    EXPECT_LE(fewer.triangles.size(), all / 3);
    EXPECT_EQ(fewer.finest_error > 2e-6, !input.wedges.uv.empty());  // cubes are flat
    EXPECT_NEAR(fewer.finest_error * fewer.transform.scale, report.finest_error, 1e-9);
  }
}

TEST(ProgressiveMesh, SameBytesForAnyNumberOfThreads) {
  const auto scheduler = make_tbb_scheduler(1);
  for (const IndexedMesh& mesh : {test::sphere_mesh(7), test::textured_torus(160, 120, true, *scheduler)})
    for (const MetricKind metric : metrics_of(mesh)) {
      const auto serial = make_serial_scheduler();
      ProgressiveReport report;
      const ProgressiveMesh first = make_progressive(mesh, {.metric = metric}, *serial, report);
      EXPECT_GT(report.rounds, 1u);
      for (const int threads : {1, 2, 5}) {
        const ProgressiveMesh other = make(mesh, {.metric = metric}, nullptr, threads);
        EXPECT_EQ(first.positions, other.positions);
        EXPECT_EQ(first.parents, other.parents);
        EXPECT_EQ(first.errors, other.errors);
        EXPECT_EQ(first.triangles, other.triangles);
        EXPECT_EQ(first.wedges.uv, other.wedges.uv);
      }
    }
}

TEST(ProgressiveMesh, CutsWhatIsNoManifoldSoThatItStaysClosed) {
  const auto scheduler = make_tbb_scheduler(1);
  const IndexedMesh mesh = test::touching_cubes(8, *scheduler);
  ProgressiveReport report;
  const ProgressiveMesh out = make(mesh, {}, &report);
  EXPECT_EQ(report.cut_edges, 8u);
  EXPECT_EQ(report.cut_vertices, 9u + 1u);
  EXPECT_EQ(test::progressive_mistake(out, mesh), "");
  expect_sound_levels(out, 0);
  EXPECT_LE(LevelFinder(out).triangles_of(out.base_vertices), 3u * 20u);
}

TEST(ProgressiveMesh, PermutedInputChangesNothingButTies) {
  const IndexedMesh mesh = test::sphere_mesh(5);
  IndexedMesh other = mesh;
  std::vector<std::uint32_t> place(mesh.positions.size());
  for (std::uint32_t v = 0; v < place.size(); ++v) place[v] = v;
  std::shuffle(place.begin(), place.end(), std::mt19937(7));
  for (std::uint32_t v = 0; v < place.size(); ++v) other.positions[place[v]] = mesh.positions[v];
  for (Triangle& t : other.triangles) t = {place[t.v[1]], place[t.v[2]], place[t.v[0]]};
  std::shuffle(other.triangles.begin(), other.triangles.end(), std::mt19937(9));
  const ProgressiveMesh a = make(mesh), b = make(other);
  EXPECT_EQ(test::triangle_values(a), test::triangle_values(b));
  EXPECT_EQ(a.vertex_count(), b.vertex_count());
  for (const std::uint32_t level : {500u, 1000u, 2000u, 3500u})
    EXPECT_NEAR(a.errors[level] / b.errors[level], 1, 0.1) << level;
}

TEST(ProgressiveMesh, TinyAndBrokenInput) {
  const auto normal = [](std::vector<Vec3d> p, std::vector<Triangle> t) {
    return test::normalised(std::move(p), std::move(t));
  };
  const std::vector<Vec3d> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<IndexedMesh> meshes{
      normal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}),             // a triangle
      normal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}),  // with its back
      normal(corners, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}),      // a tetrahedron
      normal(corners, {{0, 1, 2}, {0, 1, 3}}),                            // turned against each other
      normal(corners, {{0, 1, 2}, {1, 0, 3}, {0, 1, 3}, {1, 0, 2}}),      // an edge of four
      normal({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}),             // without area
      normal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 0}, {6, 5, 0}, {5, 6, 0}}, {{0, 1, 2}, {3, 4, 5}})};
  for (const IndexedMesh& mesh : meshes)
    for (const MetricKind metric : {MetricKind::quadric, MetricKind::attribute_quadric}) {
      const ProgressiveMesh out = make(mesh, {.metric = metric});
      EXPECT_EQ(test::progressive_mistake(out, mesh), "");
      for (const std::uint32_t level : some_levels(out, 3))
        EXPECT_EQ(LevelFinder(out).compute_level(level), test::obvious_level(out, level));
    }
}

TEST(ProgressiveMesh, ParametricNeedsTextureCoordinates) {
  EXPECT_THROW((void)make(test::sphere_mesh(2), {.metric = MetricKind::parametric}), InputError);
  EXPECT_THROW((void)progressive::metric_kind("length"), InputError);
  EXPECT_EQ(progressive::metric_kind("attribute-quadric"), MetricKind::attribute_quadric);
}

TEST(ProgressiveMesh, HardModelsGoThrough) {
  const auto scheduler = make_tbb_scheduler(2);
  LODESTONE_MODEL_OR_SKIP(folder, "hard");
  int seen = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    IndexedMesh mesh;
    try {
      Repairs repairs;
      mesh = prepare_mesh(load_mesh(entry.path(), *scheduler), repairs, *scheduler);
    } catch (const Error&) {
      continue;  // refused clearly, as by `build`
    }
    const ProgressiveMesh out = make(mesh, {}, nullptr, 2);
    EXPECT_EQ(test::progressive_mistake(out, mesh), "") << entry.path();
    const LevelFinder finder(out);
    for (const std::uint32_t level : some_levels(out, 4))
      EXPECT_EQ(finder.compute_level(level), test::obvious_level(out, level)) << entry.path();
    ++seen;
  }
  EXPECT_GT(seen, 10);
}

}  // namespace
}  // namespace lodestone
