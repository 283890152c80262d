// Cracks appear where they should and nowhere else: frames of valid hierarchies, fast forms beside their slow twins.
#include <gtest/gtest.h>

#include <vector>

#include "experiments/metrics/cracks/adversary.h"
#include "experiments/metrics/drawn/screen.h"
#include "render/camera/view.h"
#include "tests/experiments/metrics/crack_subject.h"

namespace lodestone {
namespace {

using namespace testing;

std::vector<Vec3f> views_of(const Hierarchy& hierarchy, const Radii& radii, int random, std::size_t count) {
  std::vector<Vec3f> views = random_viewpoints(hierarchy, random, 1);
  for (const AdversarialView& view : adversarial_views(hierarchy, radii, {.count = count})) {
    views.push_back(view.viewpoint);
    views.push_back(view.across);
  }
  return views;
}

// Where no point joins two parts of the surface, the two forms agree on whether there is a crack; elsewhere too a frame
// without gaps is without residual edges.
void expect_one_verdict(Subject& subject, const Frame& frame, bool manifold) {
  const bool cracked = subject.cracks(frame).open_edges > 0, gaping = subject.gaps(frame).gaps > 0;
  if (manifold) {
    EXPECT_EQ(cracked, gaping);
  } else {
    EXPECT_TRUE(gaping || !cracked);
  }
}

TEST(Cracks, NoneInAdmissibleViews) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    for (const DistanceMetric metric : both_metrics)
      for (const bool uniform : {false, true}) {
        const float rho = greatest_reach(subject.hierarchy(), metric);
        const Radii radii = uniform ? uniform_radii(subject.hierarchy(), metric, rho * 1.0001f)
                                    : per_level_radii(subject.hierarchy(), metric);
        ASSERT_TRUE(radii.admissible);
        const std::vector<Vec3f> views = views_of(subject.hierarchy(), radii, 40, 6);
        for (std::size_t i = 0; i < views.size(); ++i) {
          const Blend blend = all_blends()[i % all_blends().size()];
          const Frame frame = make_frame(subject.hierarchy(), radii, blend, views[i]);
          const CrackReport cracks = subject.cracks(frame);
          const GapReport gaps = subject.gaps(frame);
          EXPECT_EQ(cracks.open_edges, 0u);
          EXPECT_TRUE(cracks.samples.empty());
          EXPECT_EQ(cracks.uncovered_leaves, 0u);
          EXPECT_EQ(gaps.gaps, 0u);
          EXPECT_EQ(gaps.gap_max, 0);
          EXPECT_EQ(gaps.gap_mean, 0);
        }
      }
  }
}

TEST(Cracks, FastFormsEqualTheirSlowTwins) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    const bool manifold = named.name != "torn" && named.name != "non-manifold";
    std::uint64_t cracked = 0, whole = 0;
    for (const DistanceMetric metric : both_metrics)
      for (const float share : {0.3f, 0.999f, 1.001f}) {
        const Radii radii =
            uniform_radii(subject.hierarchy(), metric, share * greatest_reach(subject.hierarchy(), metric));
        for (const Vec3f view : views_of(subject.hierarchy(), radii, 2, 3)) {
          const Frame frame = make_frame(subject.hierarchy(), radii, Blend::smoothstep, view);
          expect_twins_agree(subject, frame);
          expect_one_verdict(subject, frame, manifold);
          (subject.cracks(frame).open_edges > 0 ? cracked : whole) += 1;
        }
      }
    EXPECT_GT(cracked, 0u);
    EXPECT_GT(whole, 0u);
  }
}

TEST(Cracks, AppearBelowTheReach) {
  for (const NamedMesh& named : manifold_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    for (const DistanceMetric metric : both_metrics) {
      const Radii wide = uniform_radii(subject.hierarchy(), metric, 2 * greatest_reach(subject.hierarchy(), metric));
      float best = 0;
      for (const AdversarialView& view : adversarial_views(subject.hierarchy(), wide))
        best = std::max(best, view.reach);
      for (const float share : {0.3f, 0.9f, 0.999f}) {
        const Radii radii = uniform_radii(subject.hierarchy(), metric, share * best);
        EXPECT_FALSE(radii.admissible);
        std::uint64_t open = 0, gaps = 0;
        for (const AdversarialView& view : adversarial_views(subject.hierarchy(), radii)) {
          const Frame frame = make_frame(subject.hierarchy(), radii, Blend::linear, view.viewpoint);
          open += subject.cracks(frame).open_edges;
          gaps += subject.gaps(frame).gaps;
        }
        EXPECT_GT(open, 0u) << share;
        EXPECT_GT(gaps, 0u) << share;
      }
    }
  }
}

// A frame that morphs for one viewpoint what was selected for another one, delta h_L away: the guard covers it.
TEST(Cracks, AStaleSelectionNeedsTheGuard) {
  constexpr float delta = 0.5f;
  for (const NamedMesh& named : manifold_meshes()) {
    SCOPED_TRACE(named.name);
    Subject subject(named.mesh);
    for (const DistanceMetric metric : both_metrics)
      for (const bool guarded : {false, true}) {
        RadiiConfig config;
        config.rule = RadiiRule::uniform;
        config.metric = metric;
        config.delta = guarded ? delta : 0;
        config.kappa0 = 1.0001f * (greatest_reach(subject.hierarchy(), metric) + 3 * config.delta);
        const Radii radii = make_radii(subject.hierarchy(), config);
        ASSERT_TRUE(radii.admissible);
        const std::uint64_t open = open_edges_when_stale(subject, radii, 24, delta);
        if (guarded) {
          EXPECT_EQ(open, 0u);
        } else {
          EXPECT_GT(open, 0u);
        }
      }
  }
}

TEST(Cracks, TheRootAloneIsWhole) {
  Subject subject(torn_mesh(8), 0);
  const Radii radii = per_level_radii(subject.hierarchy(), DistanceMetric::euclidean);
  const Frame frame = make_frame(subject.hierarchy(), radii, Blend::linear, {0.5f, 0.5f, 0.5f});
  expect_twins_agree(subject, frame);
  EXPECT_EQ(subject.cracks(frame).open_edges, 0u);
}

TEST(Cracks, GapsInPixelsEqualTheirSlowTwin) {
  Subject subject(torus_mesh(28));
  const Hierarchy& h = subject.hierarchy();
  const Radii radii = uniform_radii(h, DistanceMetric::euclidean, 0.3f * greatest_reach(h, DistanceMetric::euclidean));
  std::uint64_t seen = 0, hidden = 0;
  for (const AdversarialView& view : adversarial_views(h, radii)) {
    const Frame frame = make_frame(h, radii, Blend::linear, view.viewpoint);
    Camera camera;
    camera.position = to_double(view.viewpoint);
    camera.target = to_double(h.cells[view.cell].positions[view.vertex]);
    camera.vertical_fov = 0.4;
    const PlacedBounds bounds{{}, h.cells.front().bounds};
    const ImageSize size{320, 200};
    const Screen screen(View(camera, std::span(&bounds, 1), size).projection({}), size);
    const GapReport fast =
        vertex_gaps(frame.context, frame.selection, *subject.basis, *subject.scheduler, subject.scratch, &screen);
    const GapReport slow = naive_vertex_gaps(frame.context, frame.selection, &screen);
    EXPECT_EQ(fast.gaps_in_view, slow.gaps_in_view);
    EXPECT_EQ(fast.gap_max_pixels, slow.gap_max_pixels);
    EXPECT_NEAR(fast.gap_mean_pixels, slow.gap_mean_pixels, 1e-9);
    EXPECT_EQ(fast.gap_max, slow.gap_max);
    seen += fast.gaps_in_view;
    hidden += fast.gaps - fast.gaps_in_view;
  }
  EXPECT_GT(seen, 0u);
  EXPECT_GT(hidden, 0u);
}

TEST(Cracks, AreTheSameForAnyNumberOfWorkers) {
  Subject subject(sphere_mesh(16));
  const Radii radii = uniform_radii(subject.hierarchy(), DistanceMetric::euclidean,
                                    0.3f * greatest_reach(subject.hierarchy(), DistanceMetric::euclidean));
  const Vec3f view = adversarial_views(subject.hierarchy(), radii).front().viewpoint;
  const Frame frame = make_frame(subject.hierarchy(), radii, Blend::cosine, view);
  const CrackReport cracks = subject.cracks(frame);
  const GapReport gaps = subject.gaps(frame);
  ASSERT_GT(cracks.open_edges, 0u);
  for (const int threads : {1, 2, 3, 7}) {
    const auto scheduler = make_tbb_scheduler(threads);
    const auto basis = make_crack_basis(subject.hierarchy(), *scheduler);
    EXPECT_EQ(basis->boundary, subject.basis->boundary);
    EXPECT_EQ(basis->unpaired, subject.basis->unpaired);
    EXPECT_EQ(basis->copies, subject.basis->copies);
    CrackScratch scratch;
    const CrackReport again = residual_edges(frame.context, frame.selection, *basis, *scheduler, scratch);
    EXPECT_EQ(again.open_edges, cracks.open_edges);
    ASSERT_EQ(again.samples.size(), cracks.samples.size());
    for (std::size_t i = 0; i < cracks.samples.size(); ++i) {
      EXPECT_EQ(again.samples[i].from, cracks.samples[i].from);
      EXPECT_EQ(again.samples[i].to, cracks.samples[i].to);
      EXPECT_EQ(again.samples[i].multiplicity, cracks.samples[i].multiplicity);
      EXPECT_EQ(again.samples[i].cell, cracks.samples[i].cell);
    }
    const GapReport gaps_again = vertex_gaps(frame.context, frame.selection, *basis, *scheduler, scratch);
    EXPECT_EQ(gaps_again.gaps, gaps.gaps);
    EXPECT_EQ(gaps_again.gap_max, gaps.gap_max);
    EXPECT_EQ(gaps_again.gap_mean, gaps.gap_mean);
    EXPECT_EQ(gaps_again.where, gaps.where);
  }
}

}  // namespace
}  // namespace lodestone
