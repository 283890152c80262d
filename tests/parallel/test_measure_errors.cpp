// Measured errors of whole hierarchies: verified, the same for any number of threads, and what verify says of wrong
// ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/hierarchy/model/find_signatures.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/verify/verify.h"
#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/measure_errors.h"
#include "parallel/mesh/compare.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

Hierarchy built(const IndexedMesh& mesh, int threads) {
  const auto scheduler = make_tbb_scheduler(threads);
  BuildConfig config;
  config.cell_triangles = 400;
  config.sigma0 = 0.6f;
  return build_hierarchy(IndexedMesh(mesh), config, *scheduler);
}

Hierarchy measured(const IndexedMesh& mesh, int threads) {
  Hierarchy hierarchy = built(mesh, threads);
  const auto scheduler = threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
  (void)measure_errors(hierarchy, {}, *scheduler);
  return hierarchy;
}

const VerifyCheck& check_of(const VerifyReport& report, const char* name) { return *report.find(name); }

class MeasureErrors : public testing::TestWithParam<IndexedMesh (*)()> {};

TEST_P(MeasureErrors, AreValidAndBoundWhatCompareFinds) {
  const IndexedMesh mesh = GetParam()();
  Hierarchy hierarchy = measured(mesh, 2);
  ASSERT_GE(hierarchy.finest(), 2);
  hierarchy.signatures = std::make_shared<const Signatures>(find_signatures(hierarchy));
  EXPECT_TRUE(hierarchy.provenance.measured_errors);
  const VerifyReport report = verify_hierarchy(hierarchy, &mesh);
  for (const VerifyCheck& check : report.checks) EXPECT_TRUE(check.passed) << check.name << ": " << check.detail;
  const auto scheduler = make_serial_scheduler();
  const RawMesh finest = level_mesh(hierarchy, hierarchy.finest());
  for (int l = 0; l < hierarchy.finest(); ++l) {
    const MeshDistance distance = compare_meshes(level_mesh(hierarchy, l), finest, {100'000}, *scheduler);
    const double largest = std::max(distance.forward.max, distance.backward.max) / hierarchy.transform.scale;
    const double stored = double{hierarchy.levels[static_cast<std::size_t>(l)].error} * cell_size(l);
    EXPECT_GE(stored, largest * (1 - 1e-6)) << l;
    EXPECT_LE(stored, 1.5 * largest) << l;
  }
}

TEST_P(MeasureErrors, AreTheSameForAnyNumberOfThreads) {
  const IndexedMesh mesh = GetParam()();
  const Hierarchy expected = measured(mesh, 0);
  for (const int threads : {1, 2, 7}) {
    const Hierarchy hierarchy = measured(mesh, threads);
    for (std::size_t c = 0; c < expected.cells.size(); ++c)
      ASSERT_EQ(hierarchy.cells[c].error, expected.cells[c].error) << threads << " threads, cell " << c;
    for (std::size_t l = 0; l < expected.levels.size(); ++l)
      ASSERT_EQ(hierarchy.levels[l].error, expected.levels[l].error);
  }
}

TEST_P(MeasureErrors, ThatAreWrongAreFound) {
  const Hierarchy hierarchy = measured(GetParam()(), 2);
  const auto fails = [&](std::size_t cell, float error) {
    Hierarchy wrong = hierarchy;
    wrong.cells[cell].error = error;
    return !check_of(verify_hierarchy(wrong), "errors").passed;
  };
  // The first cell of the coarse level with most cells: no child's error interferes.
  const std::size_t cell = hierarchy.levels[hierarchy.levels.size() - 2].first_cell;
  EXPECT_TRUE(fails(cell, 0.7f * hierarchy.cells[cell].error)) << "too small";
  EXPECT_TRUE(fails(cell, 5)) << "larger than all displacements";
  EXPECT_TRUE(fails(0, 0.9f * hierarchy.cells[1].error)) << "smaller than a child's";
  EXPECT_TRUE(fails(hierarchy.cells.size() - 1, 0.1f)) << "on the finest level";
}

INSTANTIATE_TEST_SUITE_P(Meshes, MeasureErrors,
                         testing::Values([] { return test::sphere_mesh(6); }, [] { return test::terrain_mesh(120); },
                                         [] { return test::torus_mesh(160, 80); }),
                         [](const auto& param) { return std::to_string(param.index); });

TEST(MeasureErrors, CountTheLatticeOnEveryLevel) {
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  RawMesh raw = generate_mesh({.shape = Shape::torus, .triangles = 20'000});
  BuildConfig config;
  config.cell_triangles = 400;
  config.sigma0 = 0.6f;
  Hierarchy hierarchy =
      build_hierarchy(prepare_mesh(std::move(raw), repairs, *scheduler, {}, {12}), config, *scheduler);
  (void)measure_errors(hierarchy, {}, *scheduler);
  EXPECT_EQ(hierarchy.cells.back().error, Lattice{12}.error());
  for (const Cell& cell : hierarchy.cells) EXPECT_GE(cell.error, Lattice{12}.error());
  EXPECT_TRUE(check_of(verify_hierarchy(hierarchy), "errors").passed);
}

// Blocks locked all around, islands that go: whatever the surface, the bound is one.
TEST(MeasureErrors, BearIslands) {
  RawMesh raw = generate_mesh({.shape = Shape::torus, .triangles = 8'000});
  const auto first = static_cast<std::uint32_t>(raw.positions.size());
  for (std::uint32_t i = 0; i < 60; ++i) {
    const Vec3d at{0.03 * i - 0.9, 0.5 * std::sin(i), 0.4 * std::cos(3.0 * i)};
    for (const Vec3d d : {Vec3d{0, 0, 0}, Vec3d{0.02, 0, 0}, Vec3d{0, 0.02, 0.01}}) raw.positions.push_back(at + d);
    raw.triangles.push_back({{first + 3 * i, first + 3 * i + 1, first + 3 * i + 2}});
  }
  const auto scheduler = make_tbb_scheduler(2);
  Repairs repairs;
  const IndexedMesh mesh = prepare_mesh(std::move(raw), repairs, *scheduler);
  for (const std::string kind : {"quadric", "cluster"}) {
    BuildConfig config;
    config.cell_triangles = 200;
    config.sigma0 = 0.6f;
    config.simplifier = kind;
    Hierarchy hierarchy = build_hierarchy(IndexedMesh(mesh), config, *scheduler);
    (void)measure_errors(hierarchy, {}, *scheduler);
    const VerifyCheck check = check_of(verify_hierarchy(hierarchy), "errors");
    EXPECT_TRUE(check.passed) << check.detail;
  }
}

// Cylinders of long thin strips, their sides as flat as their many corners allow: bounds, and no more work than
// allowed.
TEST(MeasureErrors, AreBoundsOnNeedlesToo) {
  RawMesh raw;
  for (std::uint32_t part = 0; part < 3; ++part) {
    constexpr std::uint32_t around = 500;
    const auto first = static_cast<std::uint32_t>(raw.positions.size());
    for (std::uint32_t i = 0; i < around; ++i) {
      const double a = 2 * 3.14159265 * i / around, x = 0.1 * std::cos(a), y = 0.1 * std::sin(a), p = 0.3 * part;
      raw.positions.push_back({x + p, y - p, x - y});
      raw.positions.push_back({x + 0.7, y + 0.6 - p, x - y + 0.5});
      const std::uint32_t v = first + 2 * i, w = first + 2 * ((i + 1) % around);
      raw.triangles.push_back({{v, w, v + 1}});
      raw.triangles.push_back({{w, w + 1, v + 1}});
    }
  }
  const auto scheduler = make_tbb_scheduler(2);
  Repairs repairs;
  BuildConfig config;
  config.cell_triangles = 200;
  config.sigma0 = 0.3f;
  Hierarchy hierarchy = build_hierarchy(prepare_mesh(std::move(raw), repairs, *scheduler), config, *scheduler);
  ASSERT_GE(hierarchy.finest(), 2);
  const MeasureReport report = measure_errors(hierarchy, {.tests = 100}, *scheduler);
  EXPECT_GT(report.stopped, 0u);
  EXPECT_GT(report.excess, 0);
  const VerifyCheck check = check_of(verify_hierarchy(hierarchy), "errors");
  EXPECT_TRUE(check.passed) << check.detail;
}

TEST(MeasureErrors, CanBeCancelledAndReportProgress) {
  Hierarchy hierarchy = built(test::sphere_mesh(6), 2);
  const auto scheduler = make_tbb_scheduler(2);
  CancelFlag cancel{true};
  EXPECT_THROW((void)measure_errors(hierarchy, {.cancel = &cancel}, *scheduler), Cancelled);
  EXPECT_FALSE(hierarchy.provenance.measured_errors);
  double last = 0;
  const MeasureReport report =
      measure_errors(hierarchy, {.progress = [&](double share) { last = std::max(last, share); }}, *scheduler);
  EXPECT_GT(last, 0);
  EXPECT_LE(last, 1);
  EXPECT_GT(report.pieces, 0u);
}

}  // namespace
}  // namespace lodestone
