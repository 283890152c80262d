// Radii per cell: what they promise, beside definitions written out. Frames without cracks:
// experiments/metrics/test_adaptive_cracks.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "core/base/error.h"
#include "core/hierarchy/model/distance_metric.h"
#include "core/hierarchy/model/find_signatures.h"
#include "render/lod/morph.h"
#include "render/lod/radii.h"
#include "render/lod/selection.h"
#include "render/lod/verify_radii.h"
#include "tests/expect_error.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

// A surface whose errors differ from cell to cell by orders of magnitude.
const Hierarchy& rough() {
  static const test::NaiveHierarchy made = [] {
    test::NaiveHierarchy small = test::naive_hierarchy(test::torus_mesh(96, 48), 4, 0.6f);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> digits(-5, -1.5f);
    for (Cell& cell : small.hierarchy.cells) cell.error = std::pow(10.0f, digits(random));
    return small;
  }();
  return made.hierarchy;
}

RadiiConfig adaptive(float pixel_error, DistanceMetric metric = DistanceMetric::euclidean) {
  RadiiConfig config;
  config.rule = RadiiRule::adaptive;
  config.metric = metric;
  config.pixel_error = pixel_error;
  return config;
}

double largest_distance(DistanceMetric metric, const Box3f& from, const Box3f& to) {
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3f p{corner & 1 ? from.lo.x : from.hi.x, corner & 2 ? from.lo.y : from.hi.y,
                  corner & 4 ? from.lo.z : from.hi.z};
    largest = std::max(largest, double{distance(metric, p, to)});
  }
  return largest;
}

// K e / tau, written out: pixels a unit at distance 1, times what the corner of the picture adds.
double wanted(float error, const RadiiConfig& config) {
  const double half = std::tan(double{config.vertical_fov} / 2), aspect = config.aspect;
  return double{error} * config.image_height / (2 * half * config.pixel_error) *
         (1 + half * half * (1 + aspect * aspect));
}

TEST(AdaptiveRadii, KeepTheConstraintAndServeTheErrorsAround) {
  const Hierarchy& h = rough();
  EXPECT_TRUE(verify_radii(h).passed) << verify_radii(h).detail;
  for (const DistanceMetric metric : {DistanceMetric::euclidean, DistanceMetric::chebyshev})
    for (const float pixel_error : {0.1f, 1.0f, 4.0f, 64.0f}) {
      RadiiConfig config = adaptive(pixel_error, metric);
      config.delta = 0.3f;
      Radii radii = make_radii(h, config);
      EXPECT_TRUE(radii.admissible);
      ASSERT_EQ(radii.by_cell.size(), h.cells.size());
      EXPECT_TRUE(verify_radii(h, radii, config).passed);
      radii.by_cell[h.levels[2].first_cell] *= 0.9f;
      EXPECT_FALSE(verify_radii(h, radii, config).passed);
      EXPECT_NE(verify_radii(h, radii, config).detail.find("radius of cell"), std::string::npos);
    }
}

TEST(AdaptiveRadii, BreakTheConstraintWhereTheyAreAskedTo) {
  RadiiConfig config = adaptive(64);
  config.constraint = 0.5f;
  const Radii radii = make_radii(rough(), config);
  EXPECT_FALSE(radii.admissible);
  EXPECT_FALSE(verify_radii(rough(), radii, config).passed);
}

// A cell asks for its own error and, where nothing is known of the vertices it shares, for those of the cells it shares
// them with; nothing else is raised without a reason.
TEST(AdaptiveRadii, AreNoLargerThanTheyMust) {
  const Hierarchy& h = rough();
  const auto signatures = signatures_of(h);
  const RadiiConfig config = adaptive(1);
  const Radii radii = make_radii(h, config, signatures);
  std::vector<double> least;
  for (const Cell& cell : h.cells) least.push_back(wanted(cell.error, config));
  for (std::uint32_t s = 0; s < signatures->first(h.finest()); ++s)
    for (const CellId c : signatures->users(s).cells)
      for (const CellId n : signatures->users(s).cells) least[c] = std::max(least[c], wanted(h.cells[n].error, config));
  for (int level = h.finest(); level >= 1; --level) {
    const double band = double{config.beta} * cell_size(level);
    const auto radius = [&](CellId d) { return level == h.finest() ? 0 : double{radii.by_cell[d]}; };
    for (std::uint32_t s = signatures->first(level); s < signatures->first(level + 1); ++s)
      for (const CellId p : signatures->users(s).parents)
        for (const CellId d : signatures->users(s).cells)
          least[p] = std::max(least[p],
                              radius(d) + band + largest_distance(config.metric, h.cells[d].bounds, h.cells[p].bounds));
  }
  for (CellId c{0}; c < h.levels.back().first_cell; ++c) EXPECT_LE(radii.by_cell[c], least[c] * (1 + 1e-5)) << c;
}

// However coarse the tolerance is: as the surface comes near, any distance from it would fill the picture.
TEST(AdaptiveRadii, ShowTheFinestSurfaceFromItsPlace) {
  const Hierarchy& h = rough();
  for (const float pixel_error : {0.5f, 4.0f, 1000.0f}) {
    Radii radii = make_radii(h, adaptive(pixel_error));
    for (CellId c = h.levels.back().first_cell; c < h.cells.size(); ++c) {
      const Box3f& box = h.cells[c].bounds;
      std::vector<float> all;
      adaptive_lambdas({&h, &radii, Blend::linear, 0.5f * (box.lo + box.hi)}, c, all);
      EXPECT_TRUE(std::ranges::all_of(all, [](float lambda) { return lambda == 1; })) << c;
    }
    radii.by_cell.back() = -1e-3f;
    EXPECT_NE(verify_radii(h, radii, adaptive(pixel_error)).detail.find("below 0"), std::string::npos);
  }
}

TEST(AdaptiveRadii, LambdaFollowsTheSignature) {
  const Hierarchy& h = rough();
  const Radii radii = make_radii(h, adaptive(2));
  const Signatures& signatures = *radii.signatures;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> along(-0.5f, 1.5f);
  std::size_t own = 0, parents = 0, between = 0;
  for (int view = 0; view < 20; ++view) {
    const MorphContext morph{&h, &radii, Blend::linear, {along(random), along(random), along(random)}};
    for (CellId c{1}; c < h.cells.size(); ++c) {
      std::vector<float> all;
      adaptive_lambdas(morph, c, all);
      const Cell& cell = h.cells[c];
      ASSERT_EQ(all.size(), signatures.of(c).size());
      for (VertexId v{0}; v < cell.positions.size(); ++v) {
        const bool shared = v >= cell.first_shared();
        const std::size_t place = shared ? signatures.places(c)[v - cell.first_shared()] : 0;
        const std::uint32_t s = signatures.of(c)[place];
        float p = HUGE_VALF, q = -HUGE_VALF;
        for (const CellId k : signatures.users(s).parents)
          p = std::min(p, radii.by_cell[k] - distance(radii.metric, morph.viewpoint, h.cells[k].bounds));
        for (const CellId k : signatures.users(s).cells)
          q = std::max(q, radii.by_cell[k] - distance(radii.metric, morph.viewpoint, h.cells[k].bounds));
        ASSERT_FALSE(p <= 0 && q >= 0);  // the ends exclude each other
        const float lambda = p <= 0 ? 0 : q >= 0 ? 1 : 1 - blend_share(Blend::linear, -q / (p - q));
        ASSERT_EQ(lambda, vertex_lambda(morph, c, v));
        ASSERT_EQ(lambda, all[place]);
        (lambda == 1 ? own : lambda == 0 ? parents : between) += 1;
      }
    }
  }
  EXPECT_GT(own, 1000u);
  EXPECT_GT(parents, 1000u);
  EXPECT_GT(between, 1000u);
}

TEST(AdaptiveRadii, SelectAPartitionWhoseStaticCellsDoNotMove) {
  const Hierarchy& h = rough();
  const Radii radii = make_radii(h, adaptive(2));
  std::mt19937 random(2);
  std::uniform_real_distribution<float> along(-0.5f, 1.5f);
  std::size_t still = 0;
  for (int view = 0; view < 50; ++view) {
    const MorphContext morph{&h, &radii, Blend::smoothstep, {along(random), along(random), along(random)}};
    Selection selection;
    select_cells(h, radii, morph.viewpoint, {}, selection);
    std::size_t leaves = 0;
    for (const SelectedCell& s : selection.cells) {
      for (CellId up = h.cells[s.cell].parent; up != no_cell; up = h.cells[up].parent)
        ASSERT_LT(distance(radii.metric, morph.viewpoint, h.cells[up].bounds), radii.by_cell[up]);
      const float apart = distance(radii.metric, morph.viewpoint, h.cells[s.cell].bounds);
      ASSERT_TRUE(s.level == h.finest() || apart >= radii.by_cell[s.cell]);
      for (const Cell& leaf : h.cells_of(h.finest())) {
        CellId above(&leaf - h.cells.data());
        while (above != s.cell && h.cells[above].parent != no_cell) above = h.cells[above].parent;
        leaves += above == s.cell;
      }
      if (s.morphing) continue;
      ++still;
      for (VertexId v{0}; v < h.cells[s.cell].positions.size(); ++v) ASSERT_EQ(vertex_lambda(morph, s.cell, v), 1);
    }
    EXPECT_EQ(leaves, h.levels.back().cell_count);
  }
  EXPECT_GT(still, 100u);
}

// Per-level radii give a whole level the radius that its roughest cell needs.
TEST(AdaptiveRadii, OneRoughCellCostsItsNeighbourhoodAlone) {
  test::NaiveHierarchy small = test::naive_hierarchy(test::torus_mesh(192, 96), 5, 0.6f);
  Hierarchy& h = small.hierarchy;
  for (Cell& cell : h.cells) cell.error = 1e-4f * cell_size(h.level_of(CellId(&cell - h.cells.data())));
  for (CellId rough(h.levels[4].first_cell); rough != no_cell; rough = h.cells[rough].parent)
    h.cells[rough].error = 2e-2f;
  for (int l = 0; l <= h.finest(); ++l) {
    h.levels[static_cast<std::size_t>(l)].error = 0;
    for (const Cell& cell : h.cells_of(l))
      h.levels[static_cast<std::size_t>(l)].error =
          std::max(h.levels[static_cast<std::size_t>(l)].error, cell.error / cell_size(l));
  }
  const auto drawn = [&](RadiiRule rule) {
    RadiiConfig config = adaptive(1);
    config.rule = rule;
    Selection selection;
    select_cells(h, make_radii(h, config), {0.5f, 0.5f, 1.5f}, {}, selection);
    std::size_t triangles = 0;
    for (const SelectedCell& s : selection.cells) triangles += h.cells[s.cell].triangles.size();
    return triangles;
  };
  EXPECT_LT(2 * drawn(RadiiRule::adaptive), drawn(RadiiRule::per_level));
}

TEST(AdaptiveRadii, RefuseWhatMakesNoSense) {
  RadiiConfig config = adaptive(1);
  config.kappa0 = 2.0f;
  const auto make = [&] { return make_radii(rough(), config); };
  expect_error_of<InputError>(make, {"pixel error", "per-level"});
  config = adaptive(1);
  config.constraint = 1.5f;
  expect_error_of<InputError>(make, {"between 0 and 1"});
  config.constraint = 0.5f;
  EXPECT_FALSE(make_radii(rough(), config).admissible);
}

}  // namespace
}  // namespace lodestone
