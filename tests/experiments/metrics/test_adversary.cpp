#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/hierarchy/model/distance_metric.h"
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
      const std::vector<AdversarialView> views = adversarial_views(h, radii, {.count = 9});
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

// As many as asked while there are cells: where a level has few, the others give more, its best ones first.
TEST(Adversary, GivesAsManyViewsAsAsked) {
  const NaiveHierarchy built = naive_hierarchy(sphere_mesh(24), finest, sigma0);
  const Hierarchy& h = built.hierarchy;
  const Radii radii = uniform_radii(h, DistanceMetric::euclidean, 1.5f);
  const std::vector<AdversarialView> all = adversarial_views(h, radii, {.count = h.cells.size()});
  std::map<int, std::vector<CellId>> of_level;
  for (const AdversarialView& view : all) of_level[view.level].push_back(view.cell);
  ASSERT_EQ(of_level.size(), 3u);
  ASSERT_LT(of_level[1].size(), of_level[3].size());
  for (const std::size_t count : {std::size_t{1}, std::size_t{5}, 3 * of_level[1].size() + 7, all.size()}) {
    std::map<int, std::vector<CellId>> given;
    std::size_t views = 0;
    for (const AdversarialView& view : adversarial_views(h, radii, {.count = count}))
      given[view.level].push_back(view.cell), ++views;
    EXPECT_EQ(views, count);
    std::size_t most = 0;
    for (const auto& [level, cells] : given) most = std::max(most, cells.size());
    for (const auto& [level, cells] : of_level) {
      EXPECT_TRUE(std::equal(given[level].begin(), given[level].end(), cells.begin())) << level;
      EXPECT_GE(given[level].size() + 1, std::min(cells.size(), most)) << level;
    }
  }
  EXPECT_EQ(adversarial_views(h, radii, {.count = all.size() + 10}).size(), all.size());
}

// The reach is tight: where every vertex moves, the adversary finds one that has it.
TEST(Adversary, ComesCloseToTheReach) {
  for (const NamedMesh& named : manifold_meshes()) {
    SCOPED_TRACE(named.name);
    const NaiveHierarchy built = naive_hierarchy(named.mesh, finest, sigma0);
    for (const DistanceMetric metric : both_metrics) {
      const float rho = greatest_reach(built.hierarchy, metric);
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
