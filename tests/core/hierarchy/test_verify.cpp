// The verifier passes what is right and names what is wrong: every check is seen failing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/hierarchy/model/find_signatures.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/verify/verify.h"
#include "core/spatial/mesh_distance.h"
#include "tests/core/hierarchy/lattice_meshes.h"
#include "tests/core/hierarchy/verify_breakages.h"

namespace lodestone {
namespace {

using test::Breakage;
using test::breakages;
using test::finest;
using test::finest_cell;
using test::middle_cell;
using test::NaiveHierarchy;
using test::sigma0;

std::string failures_of(const VerifyReport& report) {
  std::string names;
  for (const VerifyCheck& check : report.checks)
    if (!check.passed) names += check.name + ": " + check.detail + "\n";
  return names;
}

TEST(Verify, PassesHierarchiesMadeByTheDefinitions) {
  for (const bool open : {false, true})
    for (const int levels : {0, 1, 2, 3})
      for (const float s : {0.05f, 0.2f, 0.6f}) {
        const IndexedMesh mesh = test::bumpy_sphere(4, open);
        const VerifyReport report = verify_hierarchy(test::naive_hierarchy(mesh, levels, s).hierarchy, &mesh);
        EXPECT_TRUE(report.valid()) << "L " << levels << " sigma0 " << s << "\n" << failures_of(report);
        EXPECT_EQ(report.checks.size(), 15u);
      }
}

TEST(Verify, AnswersWithoutTheInputToo) {
  const VerifyReport report = verify_hierarchy(test::naive_hierarchy(test::bumpy_sphere(3), 2, 0.2f).hierarchy);
  EXPECT_TRUE(report.valid());
  EXPECT_EQ(report.find("input"), nullptr);
  EXPECT_FALSE(VerifyReport{}.valid());
}

// Points spread over both surfaces are the slow twin of the verifier's; halved errors are exceeded twice as far.
TEST(Verify, TellsItsProgressUpToTheEnd) {
  for (const IndexedMesh& mesh : {test::bumpy_sphere(3), test::bumpy_sphere(4)}) {
    std::vector<double> told;
    (void)verify_hierarchy(test::naive_hierarchy(mesh, finest, sigma0).hierarchy, &mesh,
                           [&](double share) { told.push_back(share); });
    ASSERT_FALSE(told.empty());
    EXPECT_GT(told.front(), 0);
    EXPECT_TRUE(std::ranges::is_sorted(told));
    EXPECT_EQ(told.back(), 1);
  }
}

TEST(Verify, SaysHowFarPointsExceedTheErrors) {
  Hierarchy h = test::naive_hierarchy(test::bumpy_sphere(4), finest, sigma0).hierarchy;
  const std::vector<double> ratio = verify_hierarchy(h).error_ratio;
  ASSERT_EQ(ratio.size(), 3u);
  EXPECT_EQ(ratio[finest], 0);
  for (int l = 0; l < finest; ++l) {
    const MeshDistance distance = compare_meshes(level_mesh(h, l), level_mesh(h, finest), {50'000});
    const double sampled = std::max(distance.forward.max, distance.backward.max) / h.transform.scale;
    const double error = double{h.levels[static_cast<std::size_t>(l)].error} * cell_size(l);
    EXPECT_GT(sampled, 0);
    EXPECT_NEAR(ratio[static_cast<std::size_t>(l)], sampled / error, 0.1 * sampled / error) << l;
  }
  for (Cell& cell : h.cells) cell.error /= 2;
  for (Level& level : h.levels) level.error /= 2;
  const std::vector<double> doubled = verify_hierarchy(h).error_ratio;
  for (std::size_t l = 0; l < ratio.size(); ++l) EXPECT_NEAR(doubled[l], 2 * ratio[l], 1e-5 * ratio[l]) << l;
}

TEST(Verify, HasNoRatioWithoutStructure) {
  test::NaiveHierarchy broken = test::naive_hierarchy(test::bumpy_sphere(3), finest, sigma0);
  broken.hierarchy.cells[0].child_count = 1000;
  EXPECT_TRUE(verify_hierarchy(broken.hierarchy).error_ratio.empty());
}

TEST(Verify, SeesEveryBreakageInTheCheckMeantForIt) {
  const IndexedMesh mesh = test::bumpy_sphere(4);
  const NaiveHierarchy whole = test::naive_hierarchy(mesh, finest, sigma0);
  ASSERT_TRUE(verify_hierarchy(whole.hierarchy, &mesh).valid());
  for (const Breakage& breakage : breakages) {
    NaiveHierarchy broken = whole;
    breakage.apply(broken);
    const VerifyReport report = verify_hierarchy(broken.attach(), &mesh);
    const VerifyCheck* check = report.find(breakage.check);
    ASSERT_NE(check, nullptr) << breakage.check;
    EXPECT_FALSE(check->passed) << breakage.check << ", " << breakage.what << "\n" << failures_of(report);
    EXPECT_FALSE(check->detail.empty());
    EXPECT_FALSE(report.valid());
  }
}

TEST(Verify, ChecksSignaturesWhereThereAreSome) {
  NaiveHierarchy model = test::naive_hierarchy(test::bumpy_sphere(4), finest, sigma0);
  EXPECT_EQ(verify_hierarchy(model.attach()).find("signatures"), nullptr);
  const Signatures::Table whole = find_signatures(model.hierarchy).table();
  const auto passes = [&](const auto& change) {
    Signatures::Table table = whole;
    change(table);
    EXPECT_EQ(Signatures::fault(model.hierarchy, table), nullptr);
    model.hierarchy.signatures = std::make_shared<const Signatures>(model.hierarchy, std::move(table));
    const VerifyReport report = verify_hierarchy(model.hierarchy);
    EXPECT_EQ(report.valid(), report.find("signatures")->passed);
    return report.find("signatures")->passed;
  };
  EXPECT_TRUE(passes([](auto&) {}));
  // Another place: copies differ, or none is that of all users.
  EXPECT_FALSE(passes([](auto& t) { t.places.back() = t.places.back() == 1 ? 2 : 1; }));
  EXPECT_FALSE(passes([](auto& t) { t.places.back() = 0; }));
}

TEST(Verify, ChecksTheErrorsOfSignatures) {
  NaiveHierarchy model = test::naive_hierarchy(test::bumpy_sphere(4), finest, sigma0);
  const Signatures::Table whole = find_signatures(model.attach()).table();
  const auto failed = [&](const auto& change) {
    Signatures::Table table = whole;
    for (float& error : table.errors) change(error);
    model.hierarchy.signatures = std::make_shared<const Signatures>(model.hierarchy, std::move(table));
    std::string names;
    for (const VerifyCheck& check : verify_hierarchy(model.hierarchy).checks)
      if (!check.passed) names += check.name;
    return names;
  };
  EXPECT_EQ(failed([](float&) {}), "");
  EXPECT_EQ(failed([](float& error) { error = 0; }), "errors");  // vertices have moved
  EXPECT_EQ(failed([](float& error) { error *= 1.01f; }), "errors");
}

TEST(Verify, ChecksTheLatticeAndWhatItAddsToTheErrors) {
  const IndexedMesh mesh = test::on_lattice(test::bumpy_sphere(4), {14});
  const NaiveHierarchy whole = test::naive_hierarchy(mesh, finest, sigma0);
  EXPECT_TRUE(verify_hierarchy(whole.hierarchy, &mesh).valid())
      << failures_of(verify_hierarchy(whole.hierarchy, &mesh));
  const Breakage lattice_breakages[] = {
      {"structure", "out of range", [](auto& t) { t.hierarchy.transform.lattice.bits = 25; }},
      {"lattice", "off the lattice on the finest level",
       [](auto& t) { finest_cell(t).positions[0].x += 0.25f * t.hierarchy.transform.lattice.step(); }},
      {"lattice", "off the lattice on a coarse level",
       [](auto& t) { middle_cell(t).positions[0].z += 0.25f * t.hierarchy.transform.lattice.step(); }},
      {"lattice", "another lattice", [](auto& t) { t.hierarchy.transform.lattice.bits = 13; }},
      {"errors", "without the lattice's share", [](auto& t) { t.hierarchy.cells.back().error = 0; }},
      {"errors", "a lattice that is said to be finer", [](auto& t) { t.hierarchy.transform.lattice.bits = 15; }},
      {"input", "on another lattice", [](auto& t) { t.hierarchy.transform.lattice.bits = 15; }},
  };
  for (const Breakage& breakage : lattice_breakages) {
    NaiveHierarchy broken = whole;
    breakage.apply(broken);
    const VerifyReport report = verify_hierarchy(broken.attach(), &mesh);
    EXPECT_FALSE(report.find(breakage.check)->passed) << breakage.what;
  }
}

TEST(Verify, RunsNothingOnABrokenStructure) {
  NaiveHierarchy broken = test::naive_hierarchy(test::bumpy_sphere(3), 2, 0.2f);
  broken.hierarchy.cells[0].first_child = CellId(0xffff'fff0u);
  for (const VerifyCheck& check : verify_hierarchy(broken.attach()).checks) EXPECT_FALSE(check.passed) << check.name;
}

// A stored edge count may follow float or double, but long edges never come from nothing.
TEST(Verify, AllowsLongEdgesThatTheInputHas) {
  const IndexedMesh mesh = test::bumpy_sphere(1);  // 32 large triangles
  const VerifyReport report = verify_hierarchy(test::naive_hierarchy(mesh, 3, 0.2f).hierarchy, &mesh);
  EXPECT_TRUE(report.valid()) << failures_of(report);
}

TEST(Verify, RefusesLongEdgesWhereTheFinerLevelHasNone) {
  // Level 0 is stretched, and its stored figures say so truthfully: only the comparison of the levels can object.
  NaiveHierarchy t = test::naive_hierarchy(test::bumpy_sphere(4), 1, 0.6f);
  Level& root = t.hierarchy.levels[0];
  ASSERT_EQ(t.hierarchy.levels[1].long_edges, 0u);
  for (Vec3f& p : (*t.payloads)[0].positions) p = 64.0f * p;  // exact, so that the longest edge is, too
  root.max_edge *= 64;
  for (const Triangle& triangle : (*t.payloads)[0].triangles)
    for (std::size_t e = 0; e < 3; ++e)
      root.long_edges += length((*t.payloads)[0].positions[triangle.v[e]] -
                                (*t.payloads)[0].positions[triangle.v[(e + 1) % 3]]) > t.hierarchy.sigma0;
  ASSERT_GT(root.long_edges, 0u);
  const VerifyReport report = verify_hierarchy(t.attach());
  EXPECT_NE(report.find("edges")->detail.find("none on the finer level"), std::string::npos);
  EXPECT_FALSE(report.find("displacement")->passed);
}

}  // namespace
}  // namespace lodestone
