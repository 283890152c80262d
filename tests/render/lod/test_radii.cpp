// Radii and bands: admissible or said not to be, and right for the screen error.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "render/lod/radii.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

// Radii need the levels only.
Hierarchy levels_with(std::vector<float> reaches, float error_ratio = 0.1f) {
  Hierarchy hierarchy;
  hierarchy.sigma0 = 0.2f;
  for (const float reach : reaches) {
    Level level;
    level.reach = {reach, 0.8f * reach};
    level.error = error_ratio;
    hierarchy.levels.push_back(level);
  }
  hierarchy.levels.back().error = 0;
  return hierarchy;
}

RadiiConfig config_of(RadiiRule rule, std::optional<float> kappa0, float delta = 0) {
  RadiiConfig config;
  config.rule = rule;
  config.kappa0 = kappa0;
  config.delta = delta;
  return config;
}

// The definition in double, without guards: r_{l-1} - 2 delta h_l > r_l + (rho_l + delta) h_l for all 1 <= l < L.
bool admissible_by_definition(const Hierarchy& h, const Radii& radii, const RadiiConfig& config) {
  for (int l = 1; l < h.finest(); ++l) {
    const auto i = static_cast<std::size_t>(l);
    const double side = cell_size(l), rho = h.levels[i].reach[static_cast<std::size_t>(config.metric)];
    if (!(double{radii.select[i - 1]} - 2 * config.delta * side > radii.select[i] + (rho + config.delta) * side))
      return false;
  }
  return true;
}

void expect_sound_bands(const Hierarchy& h, const Radii& radii, const RadiiConfig& config) {
  ASSERT_EQ(radii.select.size(), h.levels.size());
  EXPECT_EQ(radii.band_begin[0], std::numeric_limits<float>::infinity());
  for (std::size_t l = 1; l < h.levels.size(); ++l) {
    const double side = cell_size(static_cast<int>(l));
    const double rho = h.levels[l].reach[static_cast<std::size_t>(config.metric)];
    EXPECT_LT(radii.band_begin[l], radii.band_end[l]) << l;
    EXPECT_GE(radii.band_begin[l], 0) << l;
    EXPECT_LE(radii.band_end[l], radii.select[l - 1] - 2 * config.delta * side * (1 - 1e-5)) << l;
    if (static_cast<int>(l) == h.finest()) continue;
    EXPECT_GE(radii.band_begin[l], radii.select[l] + (rho + config.delta) * side) << l;
  }
}

RC_GTEST_PROP(Radii, PerLevelIsAlwaysAdmissible, ()) {
  const int count = *rc::gen::inRange(1, 12);
  std::vector<float> reaches;
  for (int i = 0; i < count; ++i) reaches.push_back(static_cast<float>(*rc::gen::inRange(1, 5000)) * 1e-3f);
  const Hierarchy h = levels_with(reaches, static_cast<float>(*rc::gen::inRange(0, 300)) * 1e-3f);
  RadiiConfig config;
  if (*rc::gen::arbitrary<bool>()) config.kappa0 = static_cast<float>(*rc::gen::inRange(1, 10000)) * 1e-3f;
  config.pixel_error = static_cast<float>(*rc::gen::inRange(1, 2000)) * 1e-2f;
  config.beta = static_cast<float>(*rc::gen::inRange(1, 3000)) * 1e-3f;
  config.delta = static_cast<float>(*rc::gen::inRange(0, 500)) * 1e-3f;
  config.metric = *rc::gen::element(DistanceMetric::euclidean, DistanceMetric::chebyshev);
  const Radii radii = make_radii(h, config);
  RC_ASSERT(radii.admissible);
  RC_ASSERT(admissible_by_definition(h, radii, config));
  expect_sound_bands(h, radii, config);
  for (int l = 1; l < h.finest(); ++l) {
    const auto i = static_cast<std::size_t>(l);
    RC_ASSERT(radii.band_end[i] - radii.band_begin[i] >=
              config.beta * cell_size(l) - 1e-6f * radii.band_end[i]);  // the band that was asked for
    if (config.kappa0) RC_ASSERT(radii.select[i] >= *config.kappa0 * cell_size(l));
  }
}

RC_GTEST_PROP(Radii, UniformIsAdmissibleFromRhoOn, ()) {
  const float delta = static_cast<float>(*rc::gen::inRange(0, 300)) * 1e-3f;
  const float rho = static_cast<float>(*rc::gen::inRange(500, 5000)) * 1e-3f;
  const Hierarchy h = levels_with({9, rho, 0.5f * rho, rho, 9});  // neither the root's nor the finest level's count
  RC_ASSERT(greatest_reach(h, DistanceMetric::euclidean) == rho);
  const float border = rho + 3 * delta;
  const RadiiConfig above = config_of(RadiiRule::uniform, border * 1.0001f, delta);
  const RadiiConfig below = config_of(RadiiRule::uniform, border * 0.9999f, delta);
  RC_ASSERT(make_radii(h, above).admissible);
  RC_ASSERT(!make_radii(h, below).admissible);
  expect_sound_bands(h, make_radii(h, above), above);
}

TEST(Radii, UniformScalesWithTheCells) {
  const Hierarchy h = levels_with({1, 1, 1, 1});
  const Radii radii = make_radii(h, config_of(RadiiRule::uniform, 2.5f));
  EXPECT_FLOAT_EQ(radii.select[0], 2.5f);
  EXPECT_FLOAT_EQ(radii.select[1], 1.25f);
  EXPECT_FLOAT_EQ(radii.select[2], 0.625f);
  EXPECT_EQ(radii.select[3], 0);
  // Band [kappa0 + rho, 2 kappa0] h_l.
  EXPECT_NEAR(radii.band_begin[2], 3.5f / 4, 1e-4);
  EXPECT_NEAR(radii.band_end[2], 5.0f / 4, 1e-4);
}

TEST(Radii, InadmissibleBandsAreStepsAtTheCoarserRadius) {
  const Hierarchy h = levels_with({1, 2, 2, 2});
  const Radii radii = make_radii(h, config_of(RadiiRule::uniform, 1.0f));
  EXPECT_FALSE(radii.admissible);
  for (std::size_t l = 1; l < 3; ++l) {
    EXPECT_EQ(radii.band_begin[l], radii.select[l - 1]);
    EXPECT_EQ(radii.band_end[l], radii.select[l - 1]);
  }
}

TEST(Radii, PixelErrorHoldsAtTheCentreAndInTheCorner) {
  const Hierarchy h = levels_with({0.1f, 0.1f, 0.1f, 0.1f});
  RadiiConfig config;
  config.pixel_error = 2;
  config.image_height = 1000;
  config.vertical_fov = std::numbers::pi_v<float> / 3;
  config.aspect = 1.5f;
  const Radii radii = make_radii(h, config);
  for (std::size_t l = 0; l < 3; ++l) {
    const double error = 0.1 * cell_size(static_cast<int>(l)), tan_half = std::tan(std::numbers::pi / 6);
    // The error across the ray to the corner, at the least distance at which the level is drawn, in pixels.
    const double tan_corner = tan_half * std::sqrt(1 + 1.5 * 1.5), angle = std::atan(tan_corner);
    const double turned = std::tan(angle) - std::tan(angle - error / radii.select[l]);
    EXPECT_LE(turned * 1000 / (2 * tan_half), 2 * 1.001) << l;
    EXPECT_GE(turned * 1000 / (2 * tan_half), 2 * 0.95) << "needlessly fine at level " << l;
  }
}

TEST(Radii, OneLevelHasNothingToSelect) {
  const Radii radii = make_radii(levels_with({1}), {});
  EXPECT_TRUE(radii.admissible);
  EXPECT_EQ(radii.select, std::vector<float>{0});
}

TEST(Radii, ExactHierarchiesAreDrawnCoarseWithoutDivisionByZero) {
  const Hierarchy h = levels_with({1, 1, 1}, 0);
  const Radii radii = make_radii(h, {});
  EXPECT_TRUE(radii.admissible);
  for (const float r : radii.select) EXPECT_TRUE(std::isfinite(r));
}

TEST(Radii, ParametersOutOfRangeAreRefused) {
  const Hierarchy h = levels_with({1, 1, 1});
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  const auto refused = [&](auto change) {
    RadiiConfig config;
    change(config);
    EXPECT_THROW((void)make_radii(h, config), InputError);
  };
  for (const float bad : {0.0f, -1.0f, nan, infinity}) refused([&](RadiiConfig& c) { c.kappa0 = bad; });
  for (const float bad : {0.0f, -1.0f, nan, infinity}) refused([&](RadiiConfig& c) { c.pixel_error = bad; });
  for (const float bad : {0.0f, -1.0f, nan, infinity}) refused([&](RadiiConfig& c) { c.beta = bad; });
  for (const float bad : {-0.1f, nan, infinity}) refused([&](RadiiConfig& c) { c.delta = bad; });
  for (const float bad : {0.0f, 3.15f, nan}) refused([&](RadiiConfig& c) { c.vertical_fov = bad; });
  for (const float bad : {0.0f, -1.0f, nan, infinity}) refused([&](RadiiConfig& c) { c.aspect = bad; });
  refused([](RadiiConfig& c) { c.image_height = 0; });
  refused([](RadiiConfig& c) { c.rule = RadiiRule::uniform; });
}

TEST(Radii, ReachOfASmallHierarchyIsItsLargestInnerLevel) {
  const Hierarchy h = test::naive_hierarchy(test::torus_mesh(48, 24), 3).hierarchy;
  for (const DistanceMetric metric : {DistanceMetric::euclidean, DistanceMetric::chebyshev}) {
    const auto m = static_cast<std::size_t>(metric);
    EXPECT_EQ(greatest_reach(h, metric), std::max(h.levels[1].reach[m], h.levels[2].reach[m]));
  }
}

}  // namespace
}  // namespace lodestone
