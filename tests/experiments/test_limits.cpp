// Detail limits: whatever cells are missing, no crack; however they come and go, no pop; and the distance d' itself.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "core/hierarchy/model/distance_metric.h"
#include "experiments/metrics/cracks/cracks.h"
#include "experiments/metrics/pops/pops.h"
#include "parallel/hierarchy/build.h"
#include "render/lod/limits.h"
#include "tests/experiments/lod_frames.h"
#include "tests/experiments/naive_metrics.h"
#include "tests/experiments/small_meshes.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr float at_once = 1;

Vec3f random_point(std::mt19937& random, float lo = -0.5f, float hi = 1.5f) {
  std::uniform_real_distribution<float> along(lo, hi);
  return {along(random), along(random), along(random)};
}

Box3f random_box(std::mt19937& random, float size) {
  const Vec3f lo = random_point(random);
  return {lo, lo + size * random_point(random, 0, 1)};
}

Vec3f random_point_of(std::mt19937& random, const Box3f& box) {
  std::uniform_int_distribution<int> corner(0, 3);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto along = [&](float lo, float hi) {
    const int at = corner(random);
    return at == 0 ? lo : at == 1 ? hi : std::min(hi, lo + unit(random) * (hi - lo));
  };
  return {along(box.lo.x, box.hi.x), along(box.lo.y, box.hi.y), along(box.lo.z, box.hi.z)};
}

std::vector<DetailLimit> random_limits(std::mt19937& random, int count) {
  std::vector<DetailLimit> limits;
  for (int i = 0; i < count; ++i)
    limits.push_back({random_box(random, 0.3f), std::uniform_real_distribution<float>(0.1f, 2)(random)});
  return limits;
}

TEST(LimitedDistance, BoundsThatOfEveryPointOfABox) {
  std::mt19937 random(1);
  for (const DistanceMetric metric : both_metrics)
    for (int trial = 0; trial < 300; ++trial) {
      const std::vector<DetailLimit> limits = random_limits(random, trial % 6);
      const Vec3f viewpoint = random_point(random);
      const Box3f box = random_box(random, 0.5f);
      const float nearest = limited_distance(metric, viewpoint, box, limits);
      const float farthest = limited_farthest_distance(metric, viewpoint, box, limits);
      const Box3f inner{random_point_of(random, box), box.hi};
      EXPECT_GE(limited_distance(metric, viewpoint, inner, limits), nearest);
      for (int i = 0; i < 50; ++i) {
        const float d = limited_distance(metric, viewpoint, random_point_of(random, box), limits);
        EXPECT_LE(nearest, d);
        EXPECT_LE(d, farthest * (1 + 1e-6f));
      }
    }
}

TEST(LimitedDistance, IsLipschitzAndNoLessThanTheDistance) {
  std::mt19937 random(2);
  for (const DistanceMetric metric : both_metrics)
    for (int trial = 0; trial < 300; ++trial) {
      const std::vector<DetailLimit> limits = random_limits(random, 5);
      const Vec3f viewpoint = random_point(random), a = random_point(random), b = random_point(random);
      const float at_a = limited_distance(metric, viewpoint, a, limits);
      EXPECT_GE(at_a, distance(metric, viewpoint, a));
      EXPECT_LE(std::abs(at_a - limited_distance(metric, viewpoint, b, limits)), distance(metric, a, b) + 1e-5f);
    }
}

TEST(LimitedDistance, LimitsFarAwayChangeNoBit) {
  std::mt19937 random(3);
  std::size_t kept = 0, all = 0;
  for (const DistanceMetric metric : both_metrics)
    for (int trial = 0; trial < 300; ++trial) {
      const std::vector<DetailLimit> limits = random_limits(random, 8);
      const Vec3f viewpoint = random_point(random);
      const Box3f box = random_box(random, 0.1f);
      std::vector<DetailLimit> near;
      limits_near(metric, viewpoint, box, limits, near);
      kept += near.size(), all += limits.size();
      for (int i = 0; i < 50; ++i) {
        const Vec3f p = random_point_of(random, box);
        EXPECT_EQ(limited_distance(metric, viewpoint, p, near), limited_distance(metric, viewpoint, p, limits));
      }
    }
  EXPECT_LT(kept, all * 3 / 4);
}

// A hierarchy, and which of its cells have their children there.
class Limits : public ::testing::Test {
 protected:
  void take(const NamedMesh& named) {
    BuildConfig config;
    config.sigma0 = 0.8f;
    config.finest_level = 4;
    hierarchy_ = build_hierarchy(IndexedMesh(named.mesh), config, *scheduler_);
    basis_ = make_crack_basis(hierarchy_, *scheduler_);
    state_.assign(hierarchy_.cells.size(), ChildState::there);
  }
  void set_all(ChildState state) { state_.assign(hierarchy_.cells.size(), state); }

  LimitTracker::ChildStateOf child_state() {
    return [this](CellId cell) { return state_[cell]; };
  }

  Frame frame(const Radii& radii, Vec3f viewpoint, LimitTracker& tracker, float rate) {
    tracker.update(hierarchy_, radii, viewpoint, child_state(), rate);
    Frame f{{&hierarchy_, &radii, Blend::smoothstep, viewpoint, tracker.limits()}, {}};
    select_cells(hierarchy_, radii, viewpoint, {.limits = tracker.limits()}, f.selection);
    return f;
  }

  // Every cell that is drawn is there: all cells above it have their children.
  void expect_present(const Frame& f) {
    for (const SelectedCell& s : f.selection.cells)
      for (CellId c = hierarchy_.cells[s.cell].parent; c != no_cell; c = hierarchy_.cells[c].parent)
        ASSERT_NE(state_[c], ChildState::missing) << "cell " << s.cell;
  }

  void expect_whole(const Frame& f) {
    EXPECT_EQ(residual_edges(f.context, f.selection, *basis_, *scheduler_, scratch_).open_edges, 0u);
    EXPECT_EQ(vertex_gaps(f.context, f.selection, *basis_, *scheduler_, scratch_).gap_max, 0);
  }

  std::unique_ptr<Scheduler> scheduler_ = make_tbb_scheduler(2);
  Hierarchy hierarchy_;
  std::shared_ptr<const CrackBasis> basis_;
  CrackScratch scratch_;
  std::vector<ChildState> state_;
};

TEST_F(Limits, NoCrackWhateverIsMissing) {
  std::mt19937 random(4);
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    take(named);
    std::size_t limited = 0;
    for (const DistanceMetric metric : both_metrics)
      for (const bool uniform : {false, true}) {
        const Radii radii = uniform ? uniform_radii(hierarchy_, metric, 1.0001f * greatest_reach(hierarchy_, metric))
                                    : per_level_radii(hierarchy_, metric);
        for (const Vec3f viewpoint : random_viewpoints(hierarchy_, 25, 5)) {
          const unsigned share = 1 + random() % 4;
          for (ChildState& state : state_) state = random() % 5 < share ? ChildState::missing : ChildState::there;
          LimitTracker tracker;
          const Frame f = frame(radii, viewpoint, tracker, at_once);
          limited += tracker.limits().size();
          expect_present(f);
          expect_whole(f);
        }
      }
    EXPECT_GT(limited, 100u);
  }
}

// The reason for all of this: the drawn ancestor of a missing cell, put in its place, leaves cracks.
TEST_F(Limits, AncestorsInThePlaceOfMissingCellsCrack) {
  take(manifold_meshes().front());
  const Radii radii = per_level_radii(hierarchy_, DistanceMetric::euclidean);
  std::mt19937 random(6);
  std::uint64_t open = 0;
  for (const Vec3f viewpoint : random_viewpoints(hierarchy_, 20, 5)) {
    Frame f = make_frame(hierarchy_, radii, Blend::smoothstep, viewpoint);
    std::set<CellId> missing;
    for (CellId c{0}; c < hierarchy_.cells.size(); ++c)
      if (random() % 4 == 0) missing.insert(c);
    Selection replaced;
    for (SelectedCell s : f.selection.cells) {
      for (CellId c = hierarchy_.cells[s.cell].parent; c != no_cell; c = hierarchy_.cells[c].parent)
        if (missing.contains(c)) s.cell = c;
      s.level = static_cast<std::uint8_t>(hierarchy_.level_of(s.cell));
      if (replaced.cells.empty() || replaced.cells.back().cell != s.cell) replaced.cells.push_back(s);
    }
    open += naive_residual_edges(f.context, replaced);
  }
  EXPECT_GT(open, 0u);
}

// Cells come and go at random while the viewpoint moves; children go only when their parent was not refined.
TEST_F(Limits, NoPopWhileCellsComeAndGo) {
  std::mt19937 random(7);
  for (const NamedMesh& named : manifold_meshes()) {
    SCOPED_TRACE(named.name);
    take(named);
    set_all(ChildState::missing);
    const Radii radii = per_level_radii(hierarchy_, DistanceMetric::euclidean);
    LimitTracker tracker;
    const float rate = 0.1f;
    Vec3f viewpoint{0.5f, -0.6f, 0.6f};
    Frame before = frame(radii, viewpoint, tracker, rate);
    std::vector<DetailLimit> limits_before(tracker.limits().begin(), tracker.limits().end());
    before.context.limits = limits_before;
    std::size_t came = 0, went = 0;
    for (int i = 0; i < 200; ++i) {
      for (CellId c{0}; c < state_.size(); ++c) {
        const auto level = static_cast<std::size_t>(hierarchy_.level_of(c));
        if (static_cast<int>(level) == hierarchy_.finest()) continue;
        const bool refined = limited_distance(radii.metric, before.context.viewpoint, hierarchy_.cells[c].bounds,
                                              before.context.limits) < radii.select[level];
        switch (state_[c]) {
          case ChildState::missing:
            if (random() % 8 == 0) state_[c] = ChildState::there, ++came;
            break;
          case ChildState::there:
            if (random() % 20 == 0) state_[c] = ChildState::unwanted;
            break;
          case ChildState::unwanted:
            if (!refined) state_[c] = ChildState::missing, ++went;
            break;
        }
      }
      viewpoint = viewpoint + 0.01f * random_point(random, -1, 1.2f);
      Frame after = frame(radii, viewpoint, tracker, rate);
      expect_present(after);
      expect_whole(after);
      const PopReport pops = largest_jump(before.context, before.selection, after.context, after.selection, *scheduler_,
                                          {.limit_rate = rate});
      EXPECT_LE(pops.jump_over_bound, 1) << "frame " << i;
      before = std::move(after);
      limits_before.assign(tracker.limits().begin(), tracker.limits().end());
      before.context.limits = limits_before;
    }
    EXPECT_GT(came, 20u);
    EXPECT_GT(went, 20u);
  }
}

TEST_F(Limits, EndWhereNothingIsMissing) {
  take(manifold_meshes().front());
  set_all(ChildState::missing);
  const Radii radii = per_level_radii(hierarchy_, DistanceMetric::euclidean);
  const Vec3f viewpoint{0.5f, 0.5f, 0.9f};
  LimitTracker tracker;
  EXPECT_EQ(frame(radii, viewpoint, tracker, 0.1f).selection.cells.size(), 1u);  // the root
  EXPECT_EQ(std::vector(tracker.missing().begin(), tracker.missing().end()), std::vector{CellId(0)});
  set_all(ChildState::there);
  int frames = 0;
  while (!tracker.limits().empty() && frames < 1000) (void)frame(radii, viewpoint, tracker, 0.1f), ++frames;
  EXPECT_GT(frames, 3);
  EXPECT_LT(frames, 1000);
  const Frame plain = make_frame(hierarchy_, radii, Blend::smoothstep, viewpoint);
  EXPECT_EQ(drawn_cells(frame(radii, viewpoint, tracker, 0.1f).selection), drawn_cells(plain.selection));
}

}  // namespace
}  // namespace lodestone
