// Radii per cell: no crack and no jump beyond the bound as long as they keep their constraint, and cracks below it.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/hierarchy/model/distance_metric.h"
#include "experiments/metrics/cracks/adversary.h"
#include "experiments/metrics/pops/pops.h"
#include "tests/experiments/metrics/crack_subject.h"

namespace lodestone {
namespace {

using namespace testing;

// Errors by chance, over four orders of magnitude: neighbours differ by as much as the constraint lets them.
void roughen(Subject& subject, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> digits(-5, -1);
  for (Cell& cell : subject.built.hierarchy.cells) cell.error = std::pow(10.0f, digits(random));
}

RadiiConfig adaptive(DistanceMetric metric, float constraint = 1, float delta = 0) {
  RadiiConfig config;
  config.rule = RadiiRule::adaptive;
  config.metric = metric;
  config.pixel_error = 2;
  config.constraint = constraint;
  config.delta = delta;
  return config;
}

std::vector<Vec3f> views_of(const Hierarchy& hierarchy, const Radii& radii, int random) {
  std::vector<Vec3f> views = random_viewpoints(hierarchy, random, 1);
  for (const AdversarialView& view : adversarial_views(hierarchy, radii, {.count = 24, .slack = 2e-6f})) {
    views.push_back(view.viewpoint);
    views.push_back(view.across);
  }
  return views;
}

TEST(AdaptiveCracks, NoneWhileTheConstraintHolds) {
  std::size_t mixed = 0;
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    for (const unsigned seed : {0u, 1u, 2u}) {
      if (seed > 0) roughen(subject, seed);
      for (const DistanceMetric metric : both_metrics) {
        const Radii radii = make_radii(subject.hierarchy(), adaptive(metric));
        ASSERT_TRUE(radii.admissible);
        const std::vector<Vec3f> views = views_of(subject.hierarchy(), radii, 40);
        for (std::size_t i = 0; i < views.size(); ++i) {
          const Blend blend = all_blends()[i % all_blends().size()];
          const Frame frame = make_frame(subject.hierarchy(), radii, blend, views[i]);
          EXPECT_EQ(subject.cracks(frame).open_edges, 0u) << i;
          EXPECT_EQ(subject.gaps(frame).gaps, 0u) << i;
          for (const SelectedCell& s : frame.selection.cells) mixed += s.level != frame.selection.cells[0].level;
        }
      }
    }
  }
  EXPECT_GT(mixed, 1000u);
}

TEST(AdaptiveCracks, AppearWhereTheConstraintIsRelaxed) {
  for (const NamedMesh& named : manifold_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    roughen(subject, 1);
    for (const DistanceMetric metric : both_metrics) {
      for (const float share : {0.5f, 0.0f}) {
        const Radii radii = make_radii(subject.hierarchy(), adaptive(metric, share));
        EXPECT_FALSE(radii.admissible);
        std::uint64_t open = 0;
        for (const AdversarialView& view : adversarial_views(subject.hierarchy(), radii, {.count = 60}))
          open += subject.gaps(make_frame(subject.hierarchy(), radii, Blend::linear, view.viewpoint)).gaps;
        EXPECT_GT(open, 0u) << share;
      }
    }
  }
}

// Neighbours agree exactly where one of them is exchanged: the adversary's pairs are as near as the constraint allows.
TEST(AdaptiveCracks, TheAdversaryComesUpToTheConstraint) {
  Subject subject(torus_mesh(28));
  roughen(subject, 1);
  for (const DistanceMetric metric : both_metrics) {
    const Radii radii = make_radii(subject.hierarchy(), adaptive(metric));
    float nearest = 0;
    for (const AdversarialView& view : adversarial_views(subject.hierarchy(), radii, {.count = 60})) {
      const auto& cells = subject.hierarchy().cells;
      const CellId parent = cells[view.other].parent;
      const double radius = radii.by_cell[view.cell];
      EXPECT_NEAR(distance(metric, view.viewpoint, cells[view.cell].bounds), radius, 1e-4 * radius + 1e-6);
      EXPECT_LT(distance(metric, view.viewpoint, cells[view.cell].bounds), radii.by_cell[view.cell]);
      EXPECT_GT(distance(metric, view.across, cells[view.cell].bounds), radii.by_cell[view.cell]);
      EXPECT_NEAR(view.reach, distance(metric, view.viewpoint, cells[parent].bounds) / radii.by_cell[parent], 1e-3);
      EXPECT_LT(view.reach, 1);
      nearest = std::max(nearest, view.reach);
    }
    EXPECT_GT(nearest, 0.7f);
  }
}

TEST(AdaptiveCracks, JumpsStayBelowTheirBound) {
  for (const NamedMesh& named : manifold_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    roughen(subject, 2);
    double largest = 0;
    for (const DistanceMetric metric : both_metrics) {
      const Radii radii = make_radii(subject.hierarchy(), adaptive(metric));
      const std::vector<Vec3f> ends = views_of(subject.hierarchy(), radii, 20);
      for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        const Blend blend = i % 2 == 0 ? Blend::linear : Blend::smoothstep;
        for (const float step : {1e-3f, 1e-2f, 1.0f}) {
          const Frame a = make_frame(subject.hierarchy(), radii, blend, ends[i]);
          const Frame b = make_frame(subject.hierarchy(), radii, blend, (1 - step) * ends[i] + step * ends[i + 1]);
          const PopReport pops = largest_jump(a.context, a.selection, b.context, b.selection, *subject.scheduler);
          EXPECT_TRUE(pops.bounded);
          EXPECT_LE(pops.jump_over_bound, 1);
          largest = std::max(largest, pops.jump_over_bound);
        }
      }
    }
    EXPECT_GT(largest, 0.01);
  }
}

// A frame that morphs for one viewpoint what was selected for another one, delta h_L away: the guard covers it.
TEST(AdaptiveCracks, AStaleSelectionNeedsTheGuard) {
  constexpr float delta = 0.5f;
  Subject subject(torus_mesh(28));
  roughen(subject, 1);
  for (const DistanceMetric metric : both_metrics)
    for (const bool guarded : {false, true}) {
      const Radii radii = make_radii(subject.hierarchy(), adaptive(metric, 1, guarded ? delta : 0));
      const std::uint64_t open = open_edges_when_stale(subject, radii, 60, delta);
      if (guarded) {
        EXPECT_EQ(open, 0u);
      } else {
        EXPECT_GT(open, 0u);
      }
    }
}

}  // namespace
}  // namespace lodestone
