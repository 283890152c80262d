#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "core/mesh/edge_census.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

EdgeCensus census_of(const IndexedMesh& mesh) { return count_edges(mesh.triangles, mesh.positions.size()); }

// The slow, obvious twin.
EdgeCensus naive_census(const std::vector<Triangle>& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, int>> edges;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t.v[k], to = t.v[(k + 1) % 3];
      auto& [forward, backward] = edges[std::minmax(from, to)];
      ++(from < to ? forward : backward);
    }
  EdgeCensus census;
  for (const auto& [ends, uses] : edges) {
    const auto [forward, backward] = uses;
    ++census.edges;
    if (forward + backward == 1) ++census.border;
    if (forward + backward >= 3) ++census.non_manifold;
    if (forward == 2 && backward == 0) ++census.inconsistent;
    if (forward == 0 && backward == 2) ++census.inconsistent;
  }
  return census;
}

TEST(EdgeCensus, OfSoundSurfaces) {
  const IndexedMesh sphere = test::sphere_mesh(3);
  EXPECT_EQ(census_of(sphere), (EdgeCensus{3 * sphere.triangles.size() / 2, 0, 0, 0}));
  const IndexedMesh terrain = test::terrain_mesh(10);  // 10 x 10 squares: sides and diagonals, four borders
  EXPECT_EQ(census_of(terrain), (EdgeCensus{2 * 110 + 100, 40, 0, 0}));
}

TEST(EdgeCensus, OfNothingAndOfOneTriangle) {
  EXPECT_EQ(count_edges({}, 0), EdgeCensus{});
  EXPECT_EQ(count_edges({}, 5), EdgeCensus{});
  const std::vector<Triangle> one{{{2, 0, 1}}};
  EXPECT_EQ(count_edges(one, 3), (EdgeCensus{3, 3, 0, 0}));
}

TEST(EdgeCensus, OfFansTurnedAndDoubledTriangles) {
  const std::vector<Triangle> pair{{{0, 1, 2}}, {{1, 0, 3}}}, turned{{{0, 1, 2}}, {{0, 1, 3}}};
  EXPECT_EQ(count_edges(pair, 4), (EdgeCensus{5, 4, 0, 0}));
  EXPECT_EQ(count_edges(turned, 4), (EdgeCensus{5, 4, 0, 1}));
  const std::vector<Triangle> fan{{{0, 1, 2}}, {{1, 0, 3}}, {{0, 1, 4}}};
  EXPECT_EQ(count_edges(fan, 5), (EdgeCensus{7, 6, 1, 0}));
  // A sheet given from both sides: every edge within it belongs to four triangles.
  IndexedMesh sheet = test::terrain_mesh(4);
  for (std::size_t i = 0, n = sheet.triangles.size(); i < n; ++i) {
    Triangle back = sheet.triangles[i];
    std::swap(back.v[0], back.v[1]);
    sheet.triangles.push_back(back);
  }
  EXPECT_EQ(census_of(sheet), (EdgeCensus{2 * 20 + 16, 0, 2 * 20 + 16 - 16, 0}));
}

TEST(EdgeCensus, EqualsItsSlowTwin) {
  std::mt19937 random(1);
  for (const std::uint32_t vertices : {4u, 9u, 40u, 1000u})
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<Triangle> triangles;
      while (triangles.size() < 300) {
        const Triangle t{{static_cast<std::uint32_t>(random() % vertices),
                          static_cast<std::uint32_t>(random() % vertices),
                          static_cast<std::uint32_t>(random() % vertices)}};
        if (!is_degenerate(t)) triangles.push_back(t);
      }
      EXPECT_EQ(count_edges(triangles, vertices), naive_census(triangles));
    }
}

}  // namespace
}  // namespace lodestone
