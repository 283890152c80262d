// The guarantee on hierarchies of the real builder and both simplifiers: no crack and no pop where the radii are
// admissible; cracks below the reach from adversarial viewpoints, and pops with the step blend.
#include <gtest/gtest.h>

#include <cmath>

#include "core/simplify/simplifiers.h"
#include "experiments/metrics/cracks/adversary.h"
#include "experiments/metrics/cracks/cracks.h"
#include "experiments/metrics/pops/pops.h"
#include "parallel/hierarchy/build.h"
#include "tests/experiments/lod_frames.h"
#include "tests/experiments/naive_metrics.h"
#include "tests/experiments/small_meshes.h"

namespace lodestone {
namespace {

using namespace testing;

class Guarantee : public ::testing::TestWithParam<std::string> {
 protected:
  void take(const NamedMesh& named) {
    BuildConfig config;
    config.sigma0 = 0.8f;
    config.finest_level = 4;
    config.simplifier = GetParam();
    hierarchy_ = build_hierarchy(IndexedMesh(named.mesh), config, *scheduler_);
    basis_ = make_crack_basis(hierarchy_, *scheduler_);
  }
  [[nodiscard]] Frame frame(const Radii& radii, Blend blend, Vec3f viewpoint) const {
    return make_frame(hierarchy_, radii, blend, viewpoint);
  }
  std::uint64_t open_edges(const Frame& f) {
    return residual_edges(f.context, f.selection, *basis_, *scheduler_, scratch_).open_edges;
  }
  double gap_max(const Frame& f) { return vertex_gaps(f.context, f.selection, *basis_, *scheduler_, scratch_).gap_max; }

  std::unique_ptr<Scheduler> scheduler_ = make_tbb_scheduler(2);
  Hierarchy hierarchy_;
  std::shared_ptr<const CrackBasis> basis_;
  CrackScratch scratch_;
};

TEST_P(Guarantee, NoCrackAndNoPopWhereAdmissible) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    take(named);
    for (const DistanceMetric metric : both_metrics)
      for (const bool uniform : {false, true}) {
        const Radii radii = uniform ? uniform_radii(hierarchy_, metric, 1.0001f * greatest_reach(hierarchy_, metric))
                                    : per_level_radii(hierarchy_, metric);
        ASSERT_TRUE(radii.admissible);
        std::vector<Vec3f> views = random_viewpoints(hierarchy_, 30, 7);
        for (const AdversarialView& view : adversarial_views(hierarchy_, radii)) {
          views.push_back(view.viewpoint);
          views.push_back(view.across);
        }
        for (std::size_t i = 1; i < views.size(); ++i) {
          const Blend blend = all_blends()[i % all_blends().size()];
          const Frame before = frame(radii, blend, views[i - 1]), after = frame(radii, blend, views[i]);
          EXPECT_EQ(open_edges(after), 0u);
          EXPECT_EQ(gap_max(after), 0);
          if (blend == Blend::step) continue;
          const PopReport pops =
              largest_jump(before.context, before.selection, after.context, after.selection, *scheduler_);
          EXPECT_LE(pops.jump_over_bound, 1) << name_of(blend);
        }
      }
  }
}

TEST_P(Guarantee, CracksBelowTheReach) {
  for (const NamedMesh& named : manifold_meshes()) {
    SCOPED_TRACE(named.name);
    take(named);
    for (const DistanceMetric metric : both_metrics) {
      const float rho = greatest_reach(hierarchy_, metric);
      std::uint64_t open = 0;
      const Radii radii = uniform_radii(hierarchy_, metric, 0.3f * rho);
      for (const AdversarialView& view : adversarial_views(hierarchy_, radii, {.count = 24})) {
        const Frame f = frame(radii, Blend::smoothstep, view.viewpoint);
        open += open_edges(f);
        EXPECT_EQ(open_edges(f), naive_residual_edges(f.context, f.selection));
      }
      EXPECT_GT(open, 0u);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Simplifiers, Guarantee, ::testing::ValuesIn(simplifier_names()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace lodestone
