// Splitting over-long edges by several workers, and hierarchies of what comes of it.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/hierarchy/verify/verify.h"
#include "core/mesh/clean.h"
#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/measure_errors.h"
#include "parallel/mesh/refine_mesh.h"
#include "tests/expect_error.h"

namespace lodestone {
namespace {

// A dense torus and a few very long triangles across it, on a lattice or not, with colours or not.
RawMesh torus_with_spikes(bool colours) {
  RawMesh raw = generate_mesh({.shape = Shape::torus, .triangles = 60'000});
  const auto first = static_cast<std::uint32_t>(raw.positions.size());
  for (std::uint32_t i = 0; i < 9; ++i) {
    raw.positions.push_back({3.0 * std::cos(0.7 * i), 3.0 * std::sin(0.7 * i), 0.3 * i});
    raw.triangles.push_back({{7 * i, 7 * i + 1, first + i}});
    if (i > 1) raw.triangles.push_back({{first, first + i - 1, first + i}});
  }
  if (colours)
    for (std::size_t v = 0; v < raw.positions.size(); ++v)
      raw.wedges.colour.push_back({static_cast<std::uint8_t>(v % 251), 0, 0, 255});
  return raw;
}

struct Case {
  int lattice_bits;
  bool colours;
};

class RefineMesh : public testing::TestWithParam<Case> {
 protected:
  static IndexedMesh mesh() {
    const auto scheduler = make_serial_scheduler();
    Repairs repairs;
    return prepare_mesh(torus_with_spikes(GetParam().colours), repairs, *scheduler, {}, {GetParam().lattice_bits});
  }
};

TEST_P(RefineMesh, IsTheSameForAnyNumberOfThreads) {
  IndexedMesh expected = mesh();
  const RefineReport serial = refine_mesh(expected, 0.03);
  EXPECT_GT(serial.split, 0u);
  for (const int threads : {1, 2, 7}) {
    IndexedMesh other = mesh();
    const auto scheduler = make_tbb_scheduler(threads);
    const RefineReport report = refine_mesh(other, 0.03, *scheduler);
    EXPECT_EQ(report.triangles_after, serial.triangles_after);
    EXPECT_TRUE(other.triangles == expected.triangles);
    EXPECT_TRUE(other.positions == expected.positions);
    EXPECT_TRUE(other.wedges.vertex == expected.wedges.vertex);
    EXPECT_TRUE(other.wedges.colour == expected.wedges.colour);
  }
}

TEST_P(RefineMesh, ChoosesLevelsThatKeepItsLimit) {
  const auto scheduler = make_serial_scheduler();
  BuildConfig config;
  config.cell_triangles = 20;
  const Hierarchy plain = build_hierarchy(mesh(), config, *scheduler);
  config.refine = true;
  config.refine_limit = 1;
  BuildReport report;
  const Hierarchy refined = build_hierarchy(mesh(), config, *scheduler, &report);
  EXPECT_LE(report.refinement.triangles_after, min_refine_limit);
  EXPECT_LT(refined.finest(), plain.finest());
  config.finest_level = refined.finest();
  EXPECT_EQ(build_hierarchy(mesh(), config, *scheduler).finest(), refined.finest());
  config.finest_level = refined.finest() + 1;
  expect_error_of<InputError>([&] { (void)build_hierarchy(mesh(), config, *scheduler); }, {"--refine-limit"});
  config.refine_limit = 0;
  expect_error_of<InputError>([&] { (void)build_hierarchy(mesh(), config, *scheduler); }, {"limit"});
}

TEST_P(RefineMesh, MakesValidHierarchiesOfTheBoundedReach) {
  const auto scheduler = make_tbb_scheduler(2);
  BuildConfig config;
  config.cell_triangles = 300;
  const Hierarchy plain = build_hierarchy(mesh(), config, *scheduler);
  config.refine = true;
  BuildReport report;
  Hierarchy refined = build_hierarchy(mesh(), config, *scheduler, &report);
  EXPECT_GT(plain.levels.back().long_edges, 0u);
  EXPECT_EQ(refined.levels.back().long_edges, 0u);
  EXPECT_EQ(refined.provenance.input_triangles, report.refinement.triangles_after);
  EXPECT_GE(report.stages.count("refine"), 1u);
  const auto widest = [](const Hierarchy& h) {
    float diameter = 0;
    for (const Level& level : h.levels) diameter = std::max(diameter, level.diameter);
    return diameter;
  };
  EXPECT_GT(widest(plain), 4);
  EXPECT_LE(widest(refined), std::sqrt(3) * (1 + 4.0 / 3 * config.sigma0)) << "the bound for edges within sigma0 h";
  (void)measure_errors(refined, {}, *scheduler);
  const IndexedMesh input = mesh();
  const VerifyReport verified = verify_hierarchy(refined, &input);
  for (const VerifyCheck& check : verified.checks) EXPECT_TRUE(check.passed) << check.name << ": " << check.detail;

  // Verify sees a hierarchy that says it is refined and is not, and the other way round.
  Hierarchy wrong = plain;
  wrong.provenance.refined = true;
  EXPECT_FALSE(verify_hierarchy(wrong, &input).find("edges")->passed);
  EXPECT_FALSE(verify_hierarchy(wrong, &input).find("input")->passed);
  wrong = refined;
  wrong.provenance.refined = false;
  EXPECT_FALSE(verify_hierarchy(wrong, &input).find("input")->passed);
}

INSTANTIATE_TEST_SUITE_P(Meshes, RefineMesh,
                         testing::Values(Case{0, false}, Case{16, false}, Case{0, true}, Case{16, true}),
                         [](const auto& param) { return std::to_string(param.index); });

}  // namespace
}  // namespace lodestone
