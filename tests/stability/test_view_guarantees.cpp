// Views, camera jumps and kappa0 beside the reach, without a backend: neither cracks nor pops.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "experiments/metrics/cracks/adversary.h"
#include "experiments/metrics/cracks/cracks.h"
#include "experiments/metrics/pops/pops.h"
#include "tests/stability/view_cases.h"

namespace lodestone::test {
namespace {

struct Drawn {
  Drawn(const Radii& radii, Blend blend, Vec3f from) : context{model().get(), &radii, blend, from} {
    select_cells(*model(), radii, from, {}, selection);
  }
  MorphContext context;
  Selection selection;
};

class ViewGuarantees : public ::testing::Test {
 protected:
  void expect_no_crack(const Drawn& drawn) {
    EXPECT_EQ(residual_edges(drawn.context, drawn.selection, *basis_, *scheduler_, scratch_).open_edges, 0u);
    EXPECT_EQ(vertex_gaps(drawn.context, drawn.selection, *basis_, *scheduler_, scratch_).gap_max, 0);
  }
  [[nodiscard]] double gap(const Drawn& drawn) {
    return vertex_gaps(drawn.context, drawn.selection, *basis_, *scheduler_, scratch_).gap_max;
  }
  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
  std::shared_ptr<const CrackBasis> basis_ = make_crack_basis(*model(), *scheduler_);
  CrackScratch scratch_;
};

// From each of the views to the next: the largest jumps there are.
TEST_F(ViewGuarantees, NeitherCracksNorPops) {
  for (const DistanceMetric metric : {DistanceMetric::euclidean, DistanceMetric::chebyshev})
    for (const Blend blend : {Blend::linear, Blend::smoothstep, Blend::late}) {
      std::optional<Drawn> before;
      RadiiConfig config;
      config.metric = metric;
      config.kappa0 = 1.0f;
      const Radii radii = make_radii(*model(), config);
      for (const ViewCase& view : view_cases()) {
        SCOPED_TRACE(view.name);
        Drawn now(radii, blend, viewpoint(view.camera, model()->transform));
        expect_no_crack(now);
        if (before) {
          EXPECT_LE(
              largest_jump(before->context, before->selection, now.context, now.selection, *scheduler_).jump_over_bound,
              1);
        }
        before.emplace(std::move(now));
      }
    }
}

// Radii are admissible above the reach and its guard. Where they say so nothing cracks, the adversary included, and
// just below the largest reach of a vertex that the adversary knows it finds a crack.
TEST_F(ViewGuarantees, EndJustBelowTheReach) {
  for (const DistanceMetric metric : {DistanceMetric::euclidean, DistanceMetric::chebyshev}) {
    RadiiConfig config;
    config.rule = RadiiRule::uniform;
    config.metric = metric;
    const float rho = greatest_reach(*model(), metric);
    std::vector<float> around{rho, std::nextafter(rho, 0.0f), std::nextafter(rho, 9.0f)};
    for (const float by : {1e-6f, 4e-6f, 1e-5f, 2e-5f, 1e-4f})
      around.insert(around.end(), {rho * (1 - by), rho * (1 + by)});
    std::size_t admissible = 0;
    for (const float kappa0 : around) {
      config.kappa0 = kappa0;
      const Radii radii = make_radii(*model(), config);
      admissible += radii.admissible;
      EXPECT_TRUE(!radii.admissible || kappa0 > rho);
      EXPECT_TRUE(radii.admissible || kappa0 < 1.00005f * rho);
      if (!radii.admissible) continue;
      for (const AdversarialView& view : adversarial_views(*model(), radii))
        for (const Vec3f from : {view.viewpoint, view.across}) expect_no_crack(Drawn(radii, Blend::smoothstep, from));
    }
    EXPECT_GE(admissible, 1u);
    config.kappa0 = rho;
    float known = 0;
    for (const AdversarialView& view : adversarial_views(*model(), make_radii(*model(), config)))
      known = std::max(known, view.reach);
    EXPECT_LE(known, rho);
    EXPECT_GT(known, 0.5f * rho);
    for (const float below : {0.9999f, 0.99f, 0.9f, 0.5f}) {
      config.kappa0 = below * known;
      const Radii radii = make_radii(*model(), config);
      double widest = 0;
      for (const AdversarialView& view : adversarial_views(*model(), radii))
        widest = std::max(widest, gap(Drawn(radii, Blend::smoothstep, view.viewpoint)));
      EXPECT_GT(widest, 0) << below;
    }
  }
}

}  // namespace
}  // namespace lodestone::test
