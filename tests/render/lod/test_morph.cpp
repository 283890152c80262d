// Morph: exact at its ends, continuous between them, and without cracks exactly when the theory says so.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <set>

#include "render/lod/morph.h"
#include "render/lod/selection.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

using test::NaiveHierarchy;

const NaiveHierarchy& torus() {
  static const NaiveHierarchy small = test::naive_hierarchy(test::torus_mesh(96, 48), 4, 0.6f);
  return small;
}

const NaiveHierarchy& terrain() {
  static const NaiveHierarchy small = test::naive_hierarchy(test::terrain_mesh(48), 4, 0.6f);
  return small;
}

Radii radii_of(const Hierarchy& h, float kappa0, RadiiRule rule, DistanceMetric metric) {
  RadiiConfig config;
  config.kappa0 = kappa0;
  config.rule = rule;
  config.metric = metric;
  return make_radii(h, config);
}

std::array<std::uint32_t, 3> bits(Vec3f p) {
  return {std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
          std::bit_cast<std::uint32_t>(p.z + 0.0f)};
}

// The map form of "no crack": every vertex of the finest mesh has one position, whichever cell draws it. Returns the
// number of vertices that do not.
std::size_t torn_vertices(const NaiveHierarchy& small, const MorphContext& morph) {
  const Hierarchy& h = small.hierarchy;
  Selection selection;
  select_cells(h, *morph.radii, morph.viewpoint, {}, selection);
  std::set<std::uint32_t> drawn;
  std::map<std::uint32_t, std::map<std::array<std::uint32_t, 3>, std::uint32_t>> index_of;  // by cell and position
  for (const SelectedCell& s : selection.cells) {
    drawn.insert(s.cell);
    const auto& positions = h.cells[s.cell].positions;
    for (std::uint32_t i = 0; i < positions.size(); ++i) index_of[s.cell][bits(positions[i])] = i;
  }
  const Level& finest = h.levels.back();
  std::vector<std::set<std::array<std::uint32_t, 3>>> places(small.mesh.positions.size());
  std::map<std::uint64_t, std::uint32_t> finest_cell;
  for (std::uint32_t c = finest.first_cell; c < h.cells.size(); ++c) finest_cell[h.cells[c].code.morton] = c;
  for (const Triangle& t : small.mesh.triangles) {
    const auto p = [&](std::size_t k) { return small.mesh.positions[t.v[k]]; };
    std::uint32_t cell = finest_cell.at(CellCode::from(cell_of(barycentre(p(0), p(1), p(2)), h.finest())).morton);
    while (!drawn.count(cell)) cell = h.cells[cell].parent;
    const auto level = static_cast<std::size_t>(h.level_of(cell));
    for (const std::uint32_t v : t.v) {
      const Vec3f w = small.mesh.positions[small.ancestors[level][v]];
      places[v].insert(bits(morph_vertex(morph, cell, index_of.at(cell).at(bits(w))).position));
    }
  }
  return static_cast<std::size_t>(std::ranges::count_if(places, [](const auto& p) { return p.size() > 1; }));
}

// The viewpoint of section 1's proof that rho is tight: behind a vertex shared with another cell, on the ray from it
// through the farthest corner of its cell's bounds, just where that corner's cell is still drawn.
std::optional<Vec3f> adversary(const Hierarchy& h, const Radii& radii, std::uint32_t cell, std::uint32_t vertex) {
  const Vec3f u = h.cells[cell].positions[vertex];
  const Box3f& b = h.cells[cell].bounds;
  const auto far = [](float lo, float hi, float v) { return hi - v > v - lo ? hi : lo; };
  const Vec3f z{far(b.lo.x, b.hi.x, u.x), far(b.lo.y, b.hi.y, u.y), far(b.lo.z, b.hi.z, u.z)};
  const float away = length(z - u);
  if (!(away > 0)) return {};
  const float r = radii.select[static_cast<std::size_t>(h.level_of(cell))];
  return z + (r * 1.00001f / away) * (z - u);
}

TEST(Morph, EndsAreTheStoredVerticesBitForBit) {
  const Hierarchy& h = torus().hierarchy;
  const Radii radii = radii_of(h, 4, RadiiRule::per_level, DistanceMetric::euclidean);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> along(-0.5f, 1.5f);
  std::size_t own = 0, parents = 0, between = 0;
  for (const Blend b : all_blends()) {
    for (int view = 0; view < 10; ++view) {
      const MorphContext morph{&h, &radii, b, {along(random), along(random), along(random)}};
      for (std::uint32_t c = 0; c < h.cells.size(); ++c) {
        const Cell& cell = h.cells[c];
        std::vector<Vec3f> positions(cell.positions.size()), normals(cell.positions.size());
        std::vector<MorphedVertex> both(cell.positions.size());
        morph_cell(morph, c, positions);
        morph_cell_normals(morph, c, normals);
        morph_cell_vertices(morph, c, both);
        const int level = h.level_of(c);
        for (std::uint32_t i = 0; i < positions.size(); ++i) {
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
  const Hierarchy& h = torus().hierarchy;
  const Radii radii = radii_of(h, 3, RadiiRule::per_level, DistanceMetric::euclidean);
  for (const Blend b : all_blends()) {
    if (b == Blend::step) continue;
    for (int level = 1; level <= h.finest(); ++level) {
      const auto l = static_cast<std::size_t>(level);
      const double band = double{radii.band_end[l]} - radii.band_begin[l];
      float before = 1, before_d = 0;
      for (int i = 0; i <= 4000; ++i) {
        const float d = radii.band_end[l] * 1.1f * static_cast<float>(i) / 4000;
        const float lambda = morph_lambda({&h, &radii, b, {0, 0, 0}}, level, {d, 0, 0});
        EXPECT_LE(lambda, before);
        EXPECT_LE(double{before} - lambda, blend_lipschitz(b) * (double{d} - before_d) / band + 1e-5);
        before = lambda, before_d = d;
      }
      EXPECT_EQ(before, 0);
    }
  }
}

class Cracks : public ::testing::TestWithParam<std::tuple<DistanceMetric, RadiiRule, Blend>> {};

TEST_P(Cracks, NoneWhereAdmissible) {
  const auto [metric, rule, blend] = GetParam();
  std::mt19937 random(7);
  for (const NaiveHierarchy* small : {&torus(), &terrain()}) {
    const Hierarchy& h = small->hierarchy;
    const float kappa0 = rule == RadiiRule::uniform ? reach(h, metric) * 1.0001f : 0.05f;
    const Radii radii = radii_of(h, kappa0, rule, metric);
    ASSERT_TRUE(radii.admissible);
    for (int view = 0; view < 12; ++view) {
      // From a random place, and from behind a random shared vertex.
      const auto cell = static_cast<std::uint32_t>(random() % h.cells.size());
      const Cell& c = h.cells[cell];
      std::optional<Vec3f> v;
      if (view % 2 && !c.shared_ids.empty())
        v = adversary(h, radii, cell, c.first_shared() + static_cast<std::uint32_t>(random() % c.shared_ids.size()));
      std::uniform_real_distribution<float> along(-0.3f, 1.3f);
      if (!v) v = Vec3f{along(random), along(random), along(random)};
      EXPECT_EQ(torn_vertices(*small, {&h, &radii, blend, *v}), 0u) << "view " << view;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Cracks,
                         ::testing::Combine(::testing::Values(DistanceMetric::euclidean, DistanceMetric::chebyshev),
                                            ::testing::Values(RadiiRule::uniform, RadiiRule::per_level),
                                            ::testing::Values(Blend::linear, Blend::smootherstep, Blend::late,
                                                              Blend::step)));

TEST(Morph, CracksOpenBelowRho) {
  std::mt19937 random(11);
  const NaiveHierarchy& small = torus();
  const Hierarchy& h = small.hierarchy;
  const Radii radii =
      radii_of(h, 0.4f * reach(h, DistanceMetric::euclidean), RadiiRule::uniform, DistanceMetric::euclidean);
  ASSERT_FALSE(radii.admissible);
  std::size_t torn = 0;
  for (int view = 0; view < 40; ++view) {
    const auto cell =
        static_cast<std::uint32_t>(h.levels[1].first_cell + random() % (h.cells.size() - h.levels[1].first_cell));
    const Cell& c = h.cells[cell];
    if (c.shared_ids.empty() || h.level_of(cell) == h.finest()) continue;
    const auto vertex = c.first_shared() + static_cast<std::uint32_t>(random() % c.shared_ids.size());
    if (const auto v = adversary(h, radii, cell, vertex))
      torn += torn_vertices(small, {&h, &radii, Blend::linear, *v}) > 0;
  }
  EXPECT_GT(torn, 0u);
}

}  // namespace
}  // namespace lodestone
