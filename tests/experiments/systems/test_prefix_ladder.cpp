// Prefixes of a whole model: what each step is off by, and that a geomorph leads from one to the next without a crack.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiments/metrics/drawn/border.h"
#include "experiments/systems/progressive/prefix_ladder.h"
#include "experiments/systems/surface/surface_distance.h"
#include "tests/experiments/systems/system_models.h"

namespace lodestone {
namespace {

using namespace testing;

const WeldedSurface& surface() {
  static const WeldedSurface made = welded_surface(torus(), "test");
  return made;
}

const PrefixLadder& ladder() {
  static const PrefixLadder made(surface(), torus().transform, *make_serial_scheduler());
  return made;
}

double distance_of(const PrefixLadder::Place& place) {
  const std::vector<Vec3f> positions = ladder().positions_at(place);
  const std::vector<Triangle>& triangles = ladder().steps()[place.step].triangles;
  return surface_distance({positions, triangles}, ladder().points(),
                          tree_of({surface().positions, surface().triangles}), *make_serial_scheduler());
}

TEST(PrefixLadder, LeadsFromTheSurfaceToAFewTriangles) {
  const auto steps = ladder().steps();
  EXPECT_EQ(steps.front().triangles.size(), surface().triangles.size());
  EXPECT_EQ(steps.front().error, 0);
  EXPECT_LE(steps.back().triangles.size(), 200u);
  for (std::size_t i = 1; i < steps.size(); ++i) {
    EXPECT_LT(steps[i].triangles.size(), steps[i - 1].triangles.size());
    EXPECT_GE(steps[i].error, 1.2 * steps[i - 1].error);
    EXPECT_LE(distance_of({i, 0}), steps[i].error);
  }
}

TEST(PrefixLadder, GeomorphsAreClosedAndMeetTheNextStep) {
  for (std::size_t i = 0; i + 1 < ladder().steps().size(); ++i) {
    const LadderStep& step = ladder().steps()[i];
    for (const double share : {0.0, 0.3, 0.999}) {
      const DrawnMesh drawn = to_drawn(ladder().positions_at({i, share}), step.triangles);
      EXPECT_TRUE(border_edges(drawn.positions, drawn.triangles).empty());
    }
    const std::vector<Vec3f> end = ladder().positions_at({i, 1});
    for (std::size_t v = 0; v < end.size(); ++v) EXPECT_EQ(end[v], ladder().steps()[i + 1].positions[step.ancestor[v]]);
  }
}

TEST(PrefixLadder, TakesTheCoarsestThatIsNearEnough) {
  EXPECT_EQ(ladder().place_for(0).step, 0u);
  EXPECT_EQ(ladder().place_for(1e9).step, ladder().steps().size() - 1);
  double before = -1;
  for (double error = 1e-5; error < 0.2; error *= 1.07) {
    const PrefixLadder::Place place = ladder().place_for(error);
    EXPECT_GE(place.share, 0);
    EXPECT_LT(place.share, 1);
    EXPECT_GE(static_cast<double>(place.step) + place.share, before) << "never finer for a larger error";
    before = static_cast<double>(place.step) + place.share;
    EXPECT_LE(distance_of(place), 1.5 * error);  // between steps errors are in proportion only nearly
  }
}

// In a thousandth of the way to a point, no point moves by more than a few thousandths of the longest edges.
TEST(PrefixLadder, PointsMoveSteadily) {
  std::vector<Vec3f> before;
  double largest = 0;
  for (double error = 1e-6; error < 0.2; error *= 1.001) {
    const PrefixLadder::Place place = ladder().place_for(error);
    const std::vector<Vec3f> positions = ladder().positions_at(place);
    std::vector<Vec3f> now;
    for (const std::uint32_t v : ladder().vertex_of_points(place.step)) now.push_back(positions[v]);
    for (std::size_t p = 0; p < before.size(); ++p) largest = std::max(largest, double{length(now[p] - before[p])});
    before = std::move(now);
  }
  EXPECT_GT(largest, 0);
  EXPECT_LT(largest, 0.005);
}

TEST(PrefixLadder, IsTheSameForAnyNumberOfThreads) {
  const PrefixLadder other(surface(), torus().transform, *make_tbb_scheduler(3));
  ASSERT_EQ(other.steps().size(), ladder().steps().size());
  for (std::size_t i = 0; i < other.steps().size(); ++i) {
    EXPECT_EQ(other.steps()[i].positions, ladder().steps()[i].positions);
    EXPECT_EQ(other.steps()[i].triangles, ladder().steps()[i].triangles);
    EXPECT_EQ(other.steps()[i].error, ladder().steps()[i].error);
  }
}

TEST(ProgressiveWhole, HasNoCracks) {
  double largest = 0;
  for (const SystemRow& row : fly(torus(), {"progressive-whole"}, 1, 30)) {
    EXPECT_EQ(row.surface.value().open_edges, 0u);
    EXPECT_EQ(row.surface->t_junctions.value(), 0u);
    EXPECT_EQ(row.surface->torn_pixels.value(), 0u);
    EXPECT_LT(row.screen_error.value(), 1.5);
    ASSERT_EQ(row.surface->jump.has_value(), row.frame > 0);
    if (row.surface->jump) largest = std::max(largest, row.surface->jump->per_step.value());
  }
  EXPECT_GT(largest, 0) << "it moves";
}

}  // namespace
}  // namespace lodestone
