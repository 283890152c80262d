#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "experiments/metrics/cracks/adversary.h"
#include "tests/experiments/lod_frames.h"
#include "tests/experiments/naive_hierarchy.h"
#include "tests/experiments/small_meshes.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr int finest = 4;
constexpr float sigma0 = 0.6f;

bool draws(const Selection& selection, CellId cell) {
  return std::any_of(selection.cells.begin(), selection.cells.end(),
                     [&](const SelectedCell& s) { return s.cell == cell; });
}

TEST(Adversary, StandsWhereItsDefinitionSays) {
  for (const NamedMesh& named : manifold_meshes()) {
    SCOPED_TRACE(named.name);
    const NaiveHierarchy built = naive_hierarchy(named.mesh, finest, sigma0);
    const Hierarchy& h = built.hierarchy;
    for (const DistanceMetric metric : both_metrics) {
      const Radii radii = uniform_radii(h, metric, 1.5f);
      const std::vector<AdversarialView> views = adversarial_views(h, radii, {.per_level = 3});
      std::set<int> levels;
      for (const AdversarialView& view : views) {
        const Cell& cell = h.cells[view.cell];
        const auto l = static_cast<std::size_t>(view.level);
        const float size = cell_size(view.level), radius = radii.select[l];
        levels.insert(view.level);
        EXPECT_EQ(h.level_of(view.cell), view.level);
        EXPECT_EQ(h.level_of(view.other), view.level);
        EXPECT_LE(view.reach, h.levels[l].reach[static_cast<std::size_t>(metric)]);
        EXPECT_NEAR(distance(metric, view.viewpoint, cell.bounds), radius, 2e-5f * radius);
        EXPECT_EQ(distance(metric, view.viewpoint, cell.bounds) < radius, view.refined);
        EXPECT_EQ(distance(metric, view.across, cell.bounds) < radius, !view.refined);
        EXPECT_NEAR(distance(metric, view.viewpoint, cell.positions[view.vertex]), radius + view.reach * size,
                    2e-5f * (radius + view.reach * size));
        const Selection selection = make_frame(h, radii, Blend::linear, view.viewpoint).selection;
        EXPECT_EQ(draws(selection, view.cell), !view.refined);
        EXPECT_EQ(distance(metric, view.viewpoint, h.cells[view.other].bounds) < radius, !view.refined);
      }
      EXPECT_EQ(levels, (std::set<int>{1, 2, 3}));
      for (std::size_t i = 1; i < views.size(); ++i) {
        if (views[i].level == views[i - 1].level) {
          EXPECT_LE(views[i].reach, views[i - 1].reach);
        }
      }
    }
  }
}

// The reach is tight: where every vertex moves, the adversary finds one that has it.
TEST(Adversary, ComesCloseToTheReach) {
  for (const NamedMesh& named : manifold_meshes()) {
    SCOPED_TRACE(named.name);
    const NaiveHierarchy built = naive_hierarchy(named.mesh, finest, sigma0);
    for (const DistanceMetric metric : both_metrics) {
      const float rho = reach(built.hierarchy, metric);
      float best = 0;
      for (const AdversarialView& v : adversarial_views(built.hierarchy, uniform_radii(built.hierarchy, metric, rho)))
        best = std::max(best, v.reach);
      EXPECT_LE(best, rho);
      EXPECT_GT(best, 0.999f * rho);
    }
  }
}

TEST(Adversary, HasNothingToTearInOneCell) {
  for (const int levels : {0, 1}) {
    const NaiveHierarchy built = naive_hierarchy(sphere_mesh(8), levels, sigma0);
    EXPECT_TRUE(
        adversarial_views(built.hierarchy, per_level_radii(built.hierarchy, DistanceMetric::euclidean)).empty());
    const std::string why = why_no_adversary(built.hierarchy);
    for (const char* part : {"cells of one level only", "--camera orbit", "--cell-triangles"})
      EXPECT_NE(why.find(part), std::string::npos) << why;
  }
}

}  // namespace
}  // namespace lodestone
