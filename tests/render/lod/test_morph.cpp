// Morph: exact at its ends and continuous between them. Frames without cracks: experiments/metrics/test_cracks.cpp.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <random>

#include "core/hierarchy/model/distance_metric.h"
#include "render/lod/morph.h"
#include "tests/naive_hierarchy.h"
#include "tests/render/own_blends.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

const Hierarchy& torus() {
  static const test::NaiveHierarchy small = test::naive_hierarchy(test::torus_mesh(96, 48), 4, 0.6f);
  return small.hierarchy;
}

Radii radii_of(float kappa0) {
  RadiiConfig config;
  config.kappa0 = kappa0;
  return make_radii(torus(), config);
}

std::array<std::uint32_t, 3> bits(Vec3f p) {
  return {std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
          std::bit_cast<std::uint32_t>(p.z + 0.0f)};
}

TEST(Morph, EndsAreTheStoredVerticesBitForBit) {
  const Hierarchy& h = torus();
  const Radii radii = radii_of(4);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> along(-0.5f, 1.5f);
  std::size_t own = 0, parents = 0, between = 0;
  for (const Blend b : all_blends()) {
    for (int view = 0; view < 10; ++view) {
      const MorphContext morph{&h, &radii, b, {along(random), along(random), along(random)}};
      for (CellId c{0}; c < h.cells.size(); ++c) {
        const Cell& cell = h.cells[c];
        std::vector<Vec3f> positions(cell.positions.size()), normals(cell.positions.size());
        std::vector<MorphedVertex> both(cell.positions.size());
        morph_cell(morph, c, positions);
        morph_cell_normals(morph, c, normals);
        morph_cell_vertices(morph, c, both);
        const int level = h.level_of(c);
        for (VertexId i{0}; i < positions.size(); ++i) {
          const MorphedVertex one = morph_vertex(morph, c, i);
          ASSERT_TRUE(both[i].position == positions[i] && both[i].normal == normals[i]);
          ASSERT_TRUE(one.position == positions[i] && one.normal == normals[i]);
          ASSERT_NEAR(length(normals[i]), 1, 1e-5);
          const Vec3f w = cell.positions[i];
          const float d = distance(radii.metric, morph.viewpoint, w), lambda = morph_lambda(morph, level, w);
          if (level == 0 || d <= radii.band_begin[static_cast<std::size_t>(level)]) {
            ASSERT_EQ(lambda, 1);
            ASSERT_EQ(bits(positions[i]), bits(w));
            ASSERT_EQ(normals[i], unpack_normal(cell.normals[i]));
            ++own;
          } else if (d >= radii.band_end[static_cast<std::size_t>(level)]) {
            const Cell& parent = h.cells[cell.parent];
            ASSERT_EQ(lambda, 0);
            ASSERT_EQ(bits(positions[i]), bits(parent.positions[cell.parents[i]]));
            ASSERT_EQ(normals[i], unpack_normal(parent.normals[cell.parents[i]]));
            ++parents;
          } else {
            ASSERT_EQ(positions[i], morph_position(morph, level, w, h.cells[cell.parent].positions[cell.parents[i]]));
            ++between;
          }
        }
      }
    }
  }
  EXPECT_GT(own, 1000u);
  EXPECT_GT(parents, 1000u);
  EXPECT_GT(between, 1000u);
}

TEST(Morph, LambdaFallsContinuouslyWithTheDistance) {
  const Hierarchy& h = torus();
  const Radii radii = radii_of(3);
  for (const Blend b : test::blends_and_own()) {
    if (b == Blend::step) continue;
    for (int level = 1; level <= h.finest(); ++level) {
      const auto l = static_cast<std::size_t>(level);
      const double band = double{radii.band_end[l]} - radii.band_begin[l];
      float before = 1, before_d = 0;
      for (int i = 0; i <= 4000; ++i) {
        const float d = radii.band_end[l] * 1.1f * static_cast<float>(i) / 4000;
        const float lambda = morph_lambda({&h, &radii, b, {0, 0, 0}}, level, {d, 0, 0});
        EXPECT_LE(lambda, before + (curve_of(b) ? 1e-6f : 0.0f));
        EXPECT_LE(double{before} - lambda, blend_lipschitz(b) * (double{d} - before_d) / band + 1e-5);
        before = lambda, before_d = d;
      }
      EXPECT_EQ(before, 0);
    }
  }
}

}  // namespace
}  // namespace lodestone
