#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "core/base/error.h"
#include "experiments/metrics/cracks/adversary.h"
#include "experiments/metrics/drawn/screen.h"
#include "experiments/metrics/pops/pops.h"
#include "render/camera/view.h"
#include "tests/experiments/lod_frames.h"
#include "tests/experiments/naive_hierarchy.h"
#include "tests/experiments/naive_metrics.h"
#include "tests/experiments/small_meshes.h"
#include "tests/render/own_blends.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr int finest = 4;
constexpr float sigma0 = 0.6f;

// From eight units away, on a slightly bent way, to within 1e-3 of a vertex; the steps shorten with the distance.
std::vector<Vec3f> fly_in(const Hierarchy& hierarchy, int steps) {
  const Cell& leaf = hierarchy.cells_of(hierarchy.finest())[hierarchy.levels.back().cell_count / 3];
  const Vec3f target = leaf.positions.front();
  std::vector<Vec3f> path;
  for (int i = 0; i <= steps; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(steps);
    const float distance = 8 * std::pow(1.25e-4f, t);
    const Vec3f way{std::cos(0.7f + t), std::sin(0.7f + t), 0.4f + 0.3f * t};
    path.push_back(target + distance / length(way) * way);
  }
  return path;
}

// The path's largest figures, after holding each step to the slow twin where `with_twin` says so.
struct PathPops {
  double jump_over_bound = 0, max_jump = 0;
  std::set<int> levels_exchanged;  // finer level of the largest jumps
};

PathPops measure(const Hierarchy& hierarchy, const Radii& radii, Blend blend, std::span<const Vec3f> path,
                 int twin_every) {
  const auto scheduler = make_serial_scheduler();
  PathPops pops;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Frame before = make_frame(hierarchy, radii, blend, path[i - 1]);
    const Frame after = make_frame(hierarchy, radii, blend, path[i]);
    const PopReport report = largest_jump(before.context, before.selection, after.context, after.selection, *scheduler);
    if (static_cast<int>(i) % twin_every == 0) {
      const NaivePops slow = naive_largest_jump(before.context, before.selection, after.context, after.selection);
      EXPECT_EQ(report.max_jump, slow.max_jump);
      EXPECT_EQ(report.jump_over_bound, slow.jump_over_bound);
    }
    EXPECT_EQ(report.bounded, radii.admissible);
    EXPECT_EQ(report.above_bound > 0, report.jump_over_bound > 1);
    pops.max_jump = std::max(pops.max_jump, report.max_jump);
    pops.jump_over_bound = std::max(pops.jump_over_bound, report.jump_over_bound);
    if (report.max_jump > 0 && report.largest.level_from != report.largest.level_to)
      pops.levels_exchanged.insert(std::max(report.largest.level_from, report.largest.level_to));
  }
  return pops;
}

TEST(Pops, StayWithinTheBoundAlongAFlyIn) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    const NaiveHierarchy built = naive_hierarchy(named.mesh, finest, sigma0);
    const std::vector<Vec3f> path = fly_in(built.hierarchy, 60);
    for (const DistanceMetric metric : both_metrics)
      for (const bool uniform : {false, true}) {
        const Radii radii = uniform
                                ? uniform_radii(built.hierarchy, metric, 1.1f * greatest_reach(built.hierarchy, metric))
                                : per_level_radii(built.hierarchy, metric);
        ASSERT_TRUE(radii.admissible);
        for (const Blend blend : test::blends_and_own()) {
          const PathPops pops = measure(built.hierarchy, radii, blend, path, 1000);
          EXPECT_GT(pops.max_jump, 0) << name_of(blend);
          if (blend == Blend::step) continue;
          EXPECT_LE(pops.jump_over_bound, 1) << name_of(blend);
          EXPECT_GT(pops.jump_over_bound, 0.05) << name_of(blend);
        }
      }
  }
}

TEST(Pops, EqualTheirSlowTwin) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    const NaiveHierarchy built = naive_hierarchy(named.mesh, finest, sigma0);
    const float rho = greatest_reach(built.hierarchy, DistanceMetric::euclidean);
    for (const float share : {0.5f, 1.2f})
      measure(built.hierarchy, uniform_radii(built.hierarchy, DistanceMetric::euclidean, share * rho), Blend::cosine,
              fly_in(built.hierarchy, 6), 1);
    // Big steps that exchange several levels at once, forth and back.
    measure(built.hierarchy, per_level_radii(built.hierarchy, DistanceMetric::chebyshev), Blend::late,
            random_viewpoints(built.hierarchy, 6, 3), 1);
  }
}

// The bound knows nothing of the way between two frames, so it must hold for steps of any length.
TEST(Pops, StayWithinTheBoundOverBigSteps) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    const NaiveHierarchy built = naive_hierarchy(named.mesh, finest, sigma0);
    const std::vector<Vec3f> path = random_viewpoints(built.hierarchy, 60, 4);
    std::set<int> exchanged;
    for (const DistanceMetric metric : both_metrics) {
      const Radii radii = uniform_radii(built.hierarchy, metric, 1.02f * greatest_reach(built.hierarchy, metric));
      for (const Blend blend : {Blend::linear, Blend::smoothstep, Blend::early}) {
        const PathPops pops = measure(built.hierarchy, radii, blend, path, 1000);
        EXPECT_LE(pops.jump_over_bound, 1);
        exchanged.insert(pops.levels_exchanged.begin(), pops.levels_exchanged.end());
      }
    }
    EXPECT_GE(exchanged.size(), 2u);
  }
}

// Steps of a hair across the very places where levels are exchanged.
TEST(Pops, ExchangesOfLevelsAreInvisible) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    const NaiveHierarchy built = naive_hierarchy(named.mesh, finest, sigma0);
    const auto scheduler = make_serial_scheduler();
    for (const DistanceMetric metric : both_metrics) {
      const Radii radii = uniform_radii(built.hierarchy, metric, 1.05f * greatest_reach(built.hierarchy, metric));
      std::size_t exchanged = 0;
      for (const AdversarialView& view : adversarial_views(built.hierarchy, radii, {.count = 9, .slack = 1e-6f})) {
        const Frame before = make_frame(built.hierarchy, radii, Blend::smoothstep, view.viewpoint);
        const Frame after = make_frame(built.hierarchy, radii, Blend::smoothstep, view.across);
        exchanged += drawn_cells(before.selection) != drawn_cells(after.selection);
        const PopReport report =
            largest_jump(before.context, before.selection, after.context, after.selection, *scheduler);
        EXPECT_LE(report.jump_over_bound, 1);
        EXPECT_LT(report.max_jump, 1e-4);
      }
      EXPECT_GT(exchanged, 0u);
    }
  }
}

// A camera whose field of view changes: per-level and uniform radii of other sizes in every frame, with the
// viewpoint at rest and on its way.
TEST(Pops, StayWithinTheBoundWhileTheRadiiChange) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    const NaiveHierarchy built = naive_hierarchy(named.mesh, finest, sigma0);
    const auto scheduler = make_serial_scheduler();
    const std::vector<Vec3f> path = fly_in(built.hierarchy, 20);
    for (const DistanceMetric metric : both_metrics)
      for (const bool uniform : {false, true}) {
        const auto radii_of_size = [&](float size) {
          return uniform
                     ? uniform_radii(built.hierarchy, metric, size * 1.05f * greatest_reach(built.hierarchy, metric))
                     : per_level_radii(built.hierarchy, metric, size * 0.5f);
        };
        double largest_at_rest = 0;
        for (std::size_t i = 1; i < path.size(); ++i) {
          const Radii from = radii_of_size(1 + 0.2f * static_cast<float>(i % 7));
          const Radii to = radii_of_size(1 + 0.11f * static_cast<float>(i % 11));
          const Blend blend = i % 2 == 0 ? Blend::linear : Blend::smoothstep;
          const Frame before = make_frame(built.hierarchy, from, blend, path[i - 1]);
          for (const bool at_rest : {true, false}) {
            const Frame after = make_frame(built.hierarchy, to, blend, at_rest ? path[i - 1] : path[i]);
            const PopReport report =
                largest_jump(before.context, before.selection, after.context, after.selection, *scheduler);
            const NaivePops slow = naive_largest_jump(before.context, before.selection, after.context, after.selection);
            EXPECT_TRUE(report.bounded);
            EXPECT_LE(report.jump_over_bound, 1);
            EXPECT_EQ(report.jump_over_bound, slow.jump_over_bound);
            EXPECT_EQ(report.max_jump, slow.max_jump);
            if (at_rest) largest_at_rest = std::max(largest_at_rest, report.jump_over_bound);
          }
        }
        EXPECT_GT(largest_at_rest, 0.05);  // the bound is not so loose that nothing could break it
      }
  }
}

TEST(Pops, StepPops) {
  for (const NamedMesh& named : manifold_meshes()) {
    SCOPED_TRACE(named.name);
    const NaiveHierarchy built = naive_hierarchy(named.mesh, finest, sigma0);
    const Radii radii = per_level_radii(built.hierarchy, DistanceMetric::euclidean);
    const std::vector<Vec3f> path = fly_in(built.hierarchy, 240);
    EXPECT_GT(measure(built.hierarchy, radii, Blend::step, path, 1000).jump_over_bound, 1);
  }
}

// Long steps let the bound reach from a vertex to its parent: then an exchange without a morph keeps it, too.
TEST(Pops, LongStepsMakeTheBoundVacuous) {
  const NaiveHierarchy built = naive_hierarchy(sphere_mesh(16), finest, sigma0);
  const Radii radii = per_level_radii(built.hierarchy, DistanceMetric::euclidean);
  const auto scheduler = make_serial_scheduler();
  const auto worst = [&](Blend blend, int steps) {
    const std::vector<Vec3f> path = fly_in(built.hierarchy, steps);
    PopReport all;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Frame before = make_frame(built.hierarchy, radii, blend, path[i - 1]);
      const Frame after = make_frame(built.hierarchy, radii, blend, path[i]);
      const PopReport report =
          largest_jump(before.context, before.selection, after.context, after.selection, *scheduler);
      EXPECT_LE(report.worst.jump, report.worst.way + jump_rounding) << "no vertex goes farther than to its parents";
      EXPECT_EQ(report.vacuous, report.jump_over_bound > 0 && report.worst.bound >= report.worst.way);
      if (report.jump_over_bound > all.jump_over_bound) all = report;
    }
    return all;
  };
  const PopReport few = worst(Blend::step, 1), many = worst(Blend::step, 500);
  EXPECT_LE(few.jump_over_bound, 1);
  EXPECT_TRUE(few.vacuous) << "a step looks like a morph";
  EXPECT_GT(many.jump_over_bound, 1);
  EXPECT_FALSE(many.vacuous);
  EXPECT_FALSE(worst(Blend::smoothstep, 500).vacuous);
}

TEST(Pops, OneLevelHasNothingToBound) {
  const NaiveHierarchy built = naive_hierarchy(sphere_mesh(4), 0, sigma0);
  const Radii radii = per_level_radii(built.hierarchy, DistanceMetric::euclidean);
  const Frame before = make_frame(built.hierarchy, radii, Blend::linear, {3, 0, 0});
  const Frame after = make_frame(built.hierarchy, radii, Blend::linear, {2, 0, 0});
  const auto scheduler = make_serial_scheduler();
  const PopReport report = largest_jump(before.context, before.selection, after.context, after.selection, *scheduler);
  EXPECT_FALSE(report.bounded);
  EXPECT_EQ(report.max_jump, 0);
}

TEST(Pops, InadmissibleRadiiHaveNoBound) {
  const NaiveHierarchy built = naive_hierarchy(sphere_mesh(16), finest, sigma0);
  const Radii radii = uniform_radii(built.hierarchy, DistanceMetric::euclidean,
                                    0.5f * greatest_reach(built.hierarchy, DistanceMetric::euclidean));
  const PathPops pops = measure(built.hierarchy, radii, Blend::linear, fly_in(built.hierarchy, 60), 1000);
  EXPECT_GT(pops.max_jump, 1e-3);
}

TEST(Pops, SeesABrokenParent) {
  NaiveHierarchy built = naive_hierarchy(torus_mesh(28), finest, sigma0);
  const Radii radii = per_level_radii(built.hierarchy, DistanceMetric::euclidean);
  const std::vector<Vec3f> path = fly_in(built.hierarchy, 60);
  EXPECT_LE(measure(built.hierarchy, radii, Blend::smoothstep, path, 1000).jump_over_bound, 1);
  // Every vertex of the cell that holds the path's end goes to one and the same parent, far beyond the bound of (1).
  const std::uint32_t cell = built.hierarchy.levels[3].first_cell + built.hierarchy.levels[3].cell_count / 3;
  for (std::uint32_t& parent : (*built.payloads)[cell].parents) parent = 0;
  EXPECT_GT(measure(built.hierarchy, radii, Blend::smoothstep, path, 10).jump_over_bound, 1);
}

// Percentiles count the vertices at rest, too; pixels are those of the later camera.
TEST(Pops, PercentilesAndPixelsEqualTheirSlowTwin) {
  const auto scheduler = make_serial_scheduler();
  const auto p99 = [](const std::vector<double>& sorted) {
    return sorted.empty() ? 0
                          : sorted[static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(sorted.size()))) - 1];
  };
  std::size_t seen = 0, moving = 0;
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    const NaiveHierarchy built = naive_hierarchy(named.mesh, finest, sigma0);
    const Radii radii = per_level_radii(built.hierarchy, DistanceMetric::euclidean);
    const std::vector<Vec3f> path = fly_in(built.hierarchy, 8);
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Frame before = make_frame(built.hierarchy, radii, Blend::linear, path[i - 1]);
      const Frame after = make_frame(built.hierarchy, radii, Blend::linear, path[i]);
      Camera camera;
      camera.position = to_double(path[i]);
      camera.target = {0.5, 0.5, 0.2};
      const PlacedBounds bounds{{}, built.hierarchy.cells.front().bounds};
      const ImageSize size{320, 200};
      const Screen screen(View(camera, std::span(&bounds, 1), size).projection({}), size);
      const PopReport report = largest_jump(before.context, before.selection, after.context, after.selection,
                                            *scheduler, {.percentiles = true, .screen = &screen});
      const NaiveJumps slow = naive_jumps(before.context, before.selection, after.context, after.selection, screen);
      EXPECT_EQ(report.vertices, slow.jumps.size());
      EXPECT_EQ(report.max_jump, slow.jumps.back());
      EXPECT_EQ(report.p99_jump, p99(slow.jumps));
      EXPECT_EQ(report.vertices_in_view, slow.pixels.size());
      EXPECT_EQ(report.max_jump_pixels, slow.pixels.empty() ? 0 : slow.pixels.back());
      EXPECT_EQ(report.p99_jump_pixels, p99(slow.pixels));
      seen += slow.pixels.size();
      moving += report.p99_jump > 0;
    }
  }
  EXPECT_GT(seen, 1000u);
  EXPECT_GT(moving, 10u);
}

TEST(Pops, TakeTheBoundsOfAnother) {
  const NaiveHierarchy built = naive_hierarchy(sphere_mesh(16), finest, sigma0);
  const Radii radii = per_level_radii(built.hierarchy, DistanceMetric::euclidean);
  const Frame before = make_frame(built.hierarchy, radii, Blend::linear, {2, 0.5f, 0.5f});
  const Frame after = make_frame(built.hierarchy, radii, Blend::linear, {1.2f, 0.5f, 0.6f});
  const auto scheduler = make_serial_scheduler();
  std::vector<double> bounds = jump_bounds(before.context, after.context);
  const auto measured = [&](const JumpConfig& config) {
    return largest_jump(before.context, before.selection, after.context, after.selection, *scheduler, config)
        .jump_over_bound;
  };
  EXPECT_EQ(measured({.bounds = bounds}), measured({}));
  for (double& b : bounds) b *= 0.5;
  EXPECT_NEAR(measured({.bounds = bounds}), 2 * measured({}), 1e-9);
}

TEST(Pops, ACameraAtRestMovesNothing) {
  const NaiveHierarchy built = naive_hierarchy(terrain_mesh(20), finest, sigma0);
  const Radii radii = per_level_radii(built.hierarchy, DistanceMetric::euclidean);
  const Frame frame = make_frame(built.hierarchy, radii, Blend::linear, {0.4f, 0.5f, 0.3f});
  const auto scheduler = make_serial_scheduler();
  const PopReport report = largest_jump(frame.context, frame.selection, frame.context, frame.selection, *scheduler);
  EXPECT_EQ(report.max_jump, 0);
  EXPECT_EQ(report.jump_over_bound, 0);
  EXPECT_EQ(report.step, 0);
}

TEST(Pops, SaysWhereTheLargestJumpIs) {
  const NaiveHierarchy built = naive_hierarchy(sphere_mesh(16), finest, sigma0);
  const Radii radii = per_level_radii(built.hierarchy, DistanceMetric::euclidean);
  const Frame before = make_frame(built.hierarchy, radii, Blend::linear, {2, 0.5f, 0.5f});
  const Frame after = make_frame(built.hierarchy, radii, Blend::linear, {1.2f, 0.5f, 0.6f});
  const auto scheduler = make_serial_scheduler();
  const PopReport report = largest_jump(before.context, before.selection, after.context, after.selection, *scheduler);
  const VertexJump& largest = report.largest;
  EXPECT_EQ(largest.jump, report.max_jump);
  EXPECT_EQ(report.worst.ratio, report.jump_over_bound);
  EXPECT_NEAR(report.step, std::hypot(0.8, 0.1), 1e-6);
  EXPECT_EQ(length(to_double(largest.to) - to_double(largest.from)), largest.jump);
  EXPECT_LT(largest.vertex, built.hierarchy.cells[largest.cell].positions.size());
  EXPECT_EQ(built.hierarchy.level_of(largest.cell), std::max(largest.level_from, largest.level_to));
}

TEST(Pops, AreTheSameForAnyNumberOfWorkers) {
  const NaiveHierarchy built = naive_hierarchy(sphere_mesh(16), finest, sigma0);
  const Radii radii = per_level_radii(built.hierarchy, DistanceMetric::euclidean);
  const Frame before = make_frame(built.hierarchy, radii, Blend::step, {2, 0.5f, 0.5f});
  const Frame after = make_frame(built.hierarchy, radii, Blend::step, {1.2f, 0.5f, 0.6f});
  const auto measured = [&](Scheduler& scheduler) {
    return largest_jump(before.context, before.selection, after.context, after.selection, scheduler);
  };
  const PopReport serial = measured(*make_serial_scheduler());
  for (const int threads : {1, 2, 3, 7}) {
    const PopReport report = measured(*make_tbb_scheduler(threads));
    EXPECT_EQ(report.max_jump, serial.max_jump);
    EXPECT_EQ(report.jump_over_bound, serial.jump_over_bound);
    EXPECT_EQ(report.above_bound, serial.above_bound);
    EXPECT_EQ(report.largest.cell, serial.largest.cell);
    EXPECT_EQ(report.largest.vertex, serial.largest.vertex);
    EXPECT_EQ(report.worst.cell, serial.worst.cell);
    EXPECT_EQ(report.worst.vertex, serial.worst.vertex);
  }
}

TEST(Pops, RefusesWhatIsNoPartition) {
  const NaiveHierarchy built = naive_hierarchy(sphere_mesh(12), finest, sigma0);
  const Radii radii = per_level_radii(built.hierarchy, DistanceMetric::euclidean);
  const Frame whole = make_frame(built.hierarchy, radii, Blend::linear, {0.5f, 0.5f, 1.1f});
  ASSERT_GT(whole.selection.cells.size(), 3u);
  const auto scheduler = make_serial_scheduler();
  const auto expect_refused = [&](const Selection& selection) {
    EXPECT_THROW((void)largest_jump(whole.context, whole.selection, whole.context, selection, *scheduler), InputError);
    EXPECT_THROW((void)largest_jump(whole.context, selection, whole.context, whole.selection, *scheduler), InputError);
  };
  for (const std::size_t missing : {std::size_t{0}, std::size_t{2}, whole.selection.cells.size() - 1}) {
    Selection selection = whole.selection;
    selection.cells.erase(selection.cells.begin() + static_cast<std::ptrdiff_t>(missing));
    expect_refused(selection);
  }
  Selection twice = whole.selection;
  twice.cells.insert(twice.cells.begin(), twice.cells.front());
  expect_refused(twice);
  Selection disordered = whole.selection;
  std::swap(disordered.cells[1], disordered.cells[2]);
  expect_refused(disordered);
  expect_refused({});
}

TEST(Pops, TheRatioAllowsForRounding) {
  EXPECT_EQ(jump_ratio(0, 0), 0);
  EXPECT_EQ(jump_ratio(jump_rounding, 0), 0);
  EXPECT_EQ(jump_ratio(0.5 + jump_rounding, 0.25), 2);
  EXPECT_EQ(jump_ratio(0.5, 0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(jump_ratio(0.5, std::numeric_limits<double>::infinity()), 0);
}

}  // namespace
}  // namespace lodestone
