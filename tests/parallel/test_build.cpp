// The build: same bytes for any number of threads and any strategy; errors; cancellation; progress.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <tuple>

#include "core/base/error.h"
#include "core/hierarchy/model/find_signatures.h"
#include "core/hierarchy/verify/verify.h"
#include "core/mesh/clean.h"
#include "core/simplify/simplifiers.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "tests/hierarchy_bytes.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

BuildConfig small_cells(const std::string& kind, Strategy strategy) {
  BuildConfig config;
  config.cell_triangles = 60;
  config.sigma0 = 1;  // edges are long compared with such small cells
  config.simplifier = kind;
  config.strategy = strategy;
  return config;
}

class BuildStrategies : public testing::TestWithParam<std::string> {};

TEST_P(BuildStrategies, SameBytesForAnyThreadsAndStrategy) {
  const auto serial = make_serial_scheduler();
  const std::string expected =
      test::hierarchy_bytes(build_hierarchy(test::sphere_mesh(6), small_cells(GetParam(), Strategy::serial), *serial));
  for (const int threads : {1, 2, 3, 7, 16}) {
    const auto scheduler = make_tbb_scheduler(threads);
    for (const Strategy strategy : {Strategy::serial, Strategy::levels, Strategy::graph})
      EXPECT_TRUE(expected == test::hierarchy_bytes(
                                  build_hierarchy(test::sphere_mesh(6), small_cells(GetParam(), strategy), *scheduler)))
          << threads << " threads, " << name_of(strategy);
  }
}

// Eight workers meet in another order each time, on few cores all the more so.
TEST(Build, TwoHundredTimesTheSameBytes) {
  const RawMesh raw = test::raw_of(test::terrain_mesh(70));
  const auto built = [&](Scheduler& scheduler, Strategy strategy) {
    Repairs repairs;
    IndexedMesh mesh = prepare_mesh(RawMesh(raw), repairs, scheduler);
    return test::hierarchy_bytes(build_hierarchy(std::move(mesh), small_cells("quadric", strategy), scheduler));
  };
  const auto serial = make_serial_scheduler();
  const std::string expected = built(*serial, Strategy::serial);
  const auto scheduler = make_tbb_scheduler(8);
  for (int trial = 0; trial < 200; ++trial)
    ASSERT_TRUE(expected == built(*scheduler, trial % 4 == 0 ? Strategy::levels : Strategy::graph)) << trial;
}

IndexedMesh on_lattice(const IndexedMesh& mesh, int bits) {
  Repairs repairs;
  return clean_mesh(test::raw_of(mesh), repairs, {}, {bits});
}

std::string failures(const VerifyReport& report) {
  std::string list;
  for (const VerifyCheck& check : report.checks)
    if (!check.passed) list += check.name + ": " + check.detail + "\n";
  return list;
}

TEST_P(BuildStrategies, SameBytesInTheOrderForCompression) {
  const auto serial = make_serial_scheduler();
  const IndexedMesh mesh = on_lattice(test::sphere_mesh(6), 16);
  BuildConfig config = small_cells(GetParam(), Strategy::serial);
  config.order_cells = true;
  const std::string expected = test::hierarchy_bytes(build_hierarchy(IndexedMesh(mesh), config, *serial));
  for (const int threads : {1, 2, 7}) {
    const auto scheduler = make_tbb_scheduler(threads);
    config.strategy = Strategy::graph;
    EXPECT_TRUE(expected == test::hierarchy_bytes(build_hierarchy(IndexedMesh(mesh), config, *scheduler)))
        << threads << " threads";
  }
}

// From lattices that leave the surface as it is to one so coarse that it is mostly made of steps.
TEST_P(BuildStrategies, EveryLevelStandsOnTheLatticeAndVerifies) {
  const auto scheduler = make_tbb_scheduler(2);
  for (const auto& mesh : {test::sphere_mesh(5), test::terrain_mesh(60), test::torus_mesh(80, 40)})
    for (const int bits : {24, 16, 10, 7, 4})
      for (const bool ordered : {false, true}) {
        const IndexedMesh input = on_lattice(mesh, bits);
        BuildConfig config = small_cells(GetParam(), Strategy::graph);
        config.order_cells = ordered;
        const Hierarchy h = build_hierarchy(IndexedMesh(input), config, *scheduler);
        EXPECT_EQ(failures(verify_hierarchy(h, &input)), "") << bits << " bits";
        for (const Cell& cell : h.cells) {
          EXPECT_GE(cell.error, Lattice{bits}.error());
          for (const Vec3f p : cell.positions) ASSERT_TRUE(Lattice{bits}.holds(p));
        }
      }
}

INSTANTIATE_TEST_SUITE_P(Simplifiers, BuildStrategies, testing::ValuesIn(simplifier_names()),
                         [](const auto& tested) { return tested.param; });

// Finest levels that share their grid with the next coarser one, and ones that do not.
TEST_P(BuildStrategies, HalfLevelsVerifyAndAreTheSameForAnyThreads) {
  const auto serial = make_serial_scheduler(), parallel = make_tbb_scheduler(3);
  for (const auto& mesh : {test::sphere_mesh(5), test::terrain_mesh(60), test::torus_mesh(80, 40)})
    for (const int finest : {-1, 5}) {
      BuildConfig config = small_cells(GetParam(), Strategy::serial);
      config.half_levels = true;
      config.finest_level = finest;
      const Hierarchy h = build_hierarchy(IndexedMesh(mesh), config, *serial);
      EXPECT_EQ(failures(verify_hierarchy(h, &mesh)), "");
      EXPECT_TRUE(finest == -1 ? h.finest() % 2 == 0 : h.finest() == finest);
      for (int l = 1; l <= h.finest(); ++l)
        EXPECT_EQ(h.cells_of(l).size() == h.cells_of(l - 1).size(), l % 2 == 0) << "level " << l;
      for (const Strategy strategy : {Strategy::levels, Strategy::graph}) {
        config.strategy = strategy;
        EXPECT_TRUE(test::hierarchy_bytes(h) ==
                    test::hierarchy_bytes(build_hierarchy(IndexedMesh(mesh), config, *parallel)));
      }
    }
}

// Cells share vertices of small errors too, where a whole cell's would ask for more than the border needs.
TEST_P(BuildStrategies, KnowsTheErrorsAroundSharedVertices) {
  const auto scheduler = make_tbb_scheduler(2);
  for (const bool ordered : {false, true}) {
    BuildConfig config = small_cells(GetParam(), Strategy::graph);
    config.order_cells = ordered;
    Hierarchy h = build_hierarchy(on_lattice(test::terrain_mesh(100), 14), config, *scheduler);
    ASSERT_GE(h.finest(), 2);
    double border = 0, whole = 0;
    for (const Cell& cell : h.cells) {
      ASSERT_EQ(cell.border_errors.size(), cell.child_count == 0 ? 0 : cell.shared_ids.size());
      for (const float error : cell.border_errors) {
        ASSERT_LE(error, cell.error);
        border += error, whole += cell.error;
      }
    }
    EXPECT_LT(border, 0.9 * whole);
    h.signatures = std::make_shared<const Signatures>(find_signatures(h));
    EXPECT_EQ(failures(verify_hierarchy(h)), "");
  }
}

TEST(Build, ShrinksFourfoldPerLevel) {
  const auto scheduler = make_tbb_scheduler();
  BuildConfig config;
  config.cell_triangles = 1000;
  const Hierarchy h = build_hierarchy(test::sphere_mesh(7), config, *scheduler);
  ASSERT_GE(h.finest(), 2);
  std::uint64_t stored = 0;
  for (const Level& level : h.levels) stored += level.triangles;
  EXPECT_EQ(h.levels.back().triangles, h.provenance.input_triangles);
  EXPECT_LT(static_cast<double>(stored), 1.45 * static_cast<double>(h.provenance.input_triangles));
}

TEST(Build, HalfLevelsShrinkTwofold) {
  const auto scheduler = make_tbb_scheduler();
  BuildConfig config;
  config.cell_triangles = 1000;
  config.half_levels = true;
  const Hierarchy h = build_hierarchy(test::sphere_mesh(7), config, *scheduler);
  ASSERT_GE(h.finest(), 4);
  for (std::size_t l = 1; l < h.levels.size(); ++l) {
    const auto kept = static_cast<double>(h.levels[l - 1].triangles) / static_cast<double>(h.levels[l].triangles);
    EXPECT_GT(kept, 0.45) << "level " << l;
    EXPECT_LT(kept, 0.6) << "level " << l;
  }
}

TEST(Build, StillRelocatesVerticesOnALattice) {
  const auto scheduler = make_tbb_scheduler(2);
  const IndexedMesh input = on_lattice(test::sphere_mesh(6), 18);
  const Hierarchy h = build_hierarchy(IndexedMesh(input), small_cells("quadric", Strategy::graph), *scheduler);
  const auto less = [](Vec3f a, Vec3f b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  std::vector<Vec3f> given = input.positions;
  std::sort(given.begin(), given.end(), less);
  std::size_t moved = 0, all = 0;
  for (const Cell& cell : h.cells_of(h.finest() - 1))
    for (const Vec3f p : cell.positions.first(cell.first_shared()))  // the others may have been locked
      ++all, moved += !std::binary_search(given.begin(), given.end(), p, less);
  EXPECT_GT(moved, all / 2);
}

TEST(Build, LevelZeroAloneIsAHierarchy) {
  const auto scheduler = make_tbb_scheduler();
  BuildConfig config;
  config.finest_level = 0;
  const Hierarchy h = build_hierarchy(test::torus_mesh(20, 10), config, *scheduler);
  EXPECT_EQ(h.finest(), 0);
  EXPECT_EQ(h.cells.size(), 1u);
  EXPECT_EQ(h.cells[0].triangles.size(), 400u);
  EXPECT_TRUE(h.cells[0].parents.empty());
}

TEST(Build, RefusesConfigurationsOutOfRange) {
  const auto scheduler = make_serial_scheduler();
  const auto build_with = [&](auto change) {
    BuildConfig config;
    change(config);
    return build_hierarchy(test::torus_mesh(8, 8), config, *scheduler);
  };
  EXPECT_THROW((void)build_with([](BuildConfig& c) { c.sigma0 = 0; }), InputError);
  EXPECT_THROW((void)build_with([](BuildConfig& c) { c.sigma0 = 3; }), InputError);
  EXPECT_THROW((void)build_with([](BuildConfig& c) { c.cell_triangles = 0; }), InputError);
  EXPECT_THROW((void)build_with([](BuildConfig& c) { c.finest_level = max_level + 1; }), InputError);
  EXPECT_THROW((void)build_hierarchy(IndexedMesh{}, {}, *scheduler), InputError);
  EXPECT_THROW((void)strategy_named("fastest"), InputError);
}

TEST(Build, StopsWhenCancelled) {
  CancelFlag cancel{true};
  for (const Strategy strategy : {Strategy::serial, Strategy::levels, Strategy::graph}) {
    BuildConfig config = small_cells("cluster", strategy);
    config.cancel = &cancel;
    const auto scheduler = make_tbb_scheduler(2);
    EXPECT_THROW((void)build_hierarchy(test::sphere_mesh(5), config, *scheduler), Cancelled);
  }
}

TEST(Build, ReportsProgressAndTimes) {
  BuildConfig config = small_cells("cluster", Strategy::graph);
  std::vector<double> shares;
  config.progress = [&](double share) { shares.push_back(share); };
  BuildReport report;
  const auto scheduler = make_tbb_scheduler(2);
  (void)build_hierarchy(test::sphere_mesh(6), config, *scheduler, &report);
  ASSERT_FALSE(shares.empty());
  for (const double share : shares) EXPECT_TRUE(share > 0 && share <= 1);
  EXPECT_GT(shares.back(), 0.5);
  EXPECT_GE(report.total.seconds, report.stages.at("partition").seconds);
  EXPECT_TRUE(report.stages.contains("hierarchy"));
}

}  // namespace
}  // namespace lodestone
