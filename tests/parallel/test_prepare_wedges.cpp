// Attributes through cleaning and welding.
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>
#include <tuple>

#include "core/mesh/clean.h"
#include "parallel/clean/prepare.h"

namespace lodestone {
namespace {

// Triangles over few positions: repeats, degenerate ones and duplicates are frequent; some corners are not numbers.
RawMesh dirty_mesh(unsigned seed) {
  std::mt19937 random(seed);
  RawMesh raw;
  for (int i = 0; i < 60; ++i) {
    const auto coordinate = [&] { return static_cast<double>(random() % 3); };
    raw.positions.push_back({coordinate(), coordinate(), coordinate()});
  }
  raw.positions[7].x = std::numeric_limits<double>::quiet_NaN();
  for (int t = 0; t < 400; ++t) {
    const auto vertex = [&] { return static_cast<std::uint32_t>(random() % raw.positions.size()); };
    raw.triangles.push_back({{vertex(), vertex(), vertex()}});
  }
  return raw;
}

IndexedMesh prepared(RawMesh raw, int threads) {
  Repairs repairs;
  const auto scheduler = make_tbb_scheduler(threads);
  return prepare_mesh(std::move(raw), repairs, *scheduler);
}

// Every corner has a wedge and a colour of its own, which tells where it comes from.
TEST(PrepareWedges, FollowTheirCorners) {
  RawMesh raw = dirty_mesh(1);
  for (std::uint32_t t = 0; t < raw.triangles.size(); ++t) {
    const std::uint32_t first = 3 * t;
    raw.wedges.corners.push_back({{first, first + 1, first + 2}});
    raw.wedges.material.push_back(t);
    for (std::uint8_t k = 0; k < 3; ++k)
      raw.wedges.colour.push_back({static_cast<std::uint8_t>(t & 255), static_cast<std::uint8_t>(t >> 8), k, 255});
  }
  const IndexedMesh mesh = prepared(raw, 3);
  ASSERT_EQ(mesh.wedges.colour.size(), mesh.positions.size());
  ASSERT_EQ(mesh.wedges.material.size(), mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t w = mesh.triangles[t].v[k];
      const Rgba8 from = mesh.wedges.colour[w];
      const std::uint32_t triangle = from.r + 256u * from.g;
      EXPECT_EQ(triangle, mesh.wedges.material[w]);
      EXPECT_EQ(from.b, k);
      EXPECT_EQ(mesh.positions[w], normalise(mesh.transform, raw.positions[raw.triangles[triangle].v[k]]));
    }
}

TEST(PrepareWedges, AreAsFewAsThereAreValues) {
  for (unsigned seed = 2; seed < 8; ++seed) {
    RawMesh raw = dirty_mesh(seed);
    for (std::uint32_t v = 0; v < raw.positions.size(); ++v) {
      raw.wedges.uv.push_back({v % 2 == 0 ? 0.0f : -0.0f, static_cast<float>(v % 2)});
      raw.wedges.normal.push_back({0, 0, v % 3 == 0 ? 1.0f : -1.0f});
    }
    const IndexedMesh mesh = prepared(raw, 2);
    Repairs repairs;
    RawMesh shape = raw;
    shape.wedges = {};
    const IndexedMesh clean = clean_mesh(shape, repairs);
    ASSERT_EQ(mesh.triangles.size(), clean.triangles.size());
    using Value = std::tuple<float, float, float, float, float>;
    std::set<Value> values;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t w = mesh.triangles[t].v[k];
        EXPECT_EQ(mesh.positions[w], clean.positions[clean.triangles[t].v[k]]);
        const Vec3f p = mesh.positions[w];
        values.emplace(p.x, p.y, p.z, mesh.wedges.uv[w].y, mesh.wedges.normal[w].z);
      }
    EXPECT_EQ(values.size(), mesh.positions.size());
    for (std::uint32_t w = 0; w < mesh.positions.size(); ++w) {
      const std::uint32_t first = mesh.wedges.vertex[w];
      ASSERT_LE(first, w);
      EXPECT_EQ(mesh.wedges.vertex[first], first);
      EXPECT_EQ(mesh.positions[first], mesh.positions[w]);
      for (std::uint32_t x = 0; x < first; ++x) EXPECT_NE(mesh.positions[x], mesh.positions[w]);
    }
  }
}

TEST(PrepareWedges, DoNotDependOnTheWorkers) {
  RawMesh raw = dirty_mesh(9);
  for (std::uint32_t v = 0; v < raw.positions.size(); ++v) raw.wedges.uv.push_back({static_cast<float>(v % 4), 0});
  const IndexedMesh one = prepared(raw, 1), many = prepared(raw, 7);
  EXPECT_EQ(one.positions, many.positions);
  EXPECT_EQ(one.triangles, many.triangles);
  EXPECT_EQ(one.wedges.uv, many.wedges.uv);
  EXPECT_EQ(one.wedges.vertex, many.wedges.vertex);
}

TEST(PrepareWedges, WhatIsNoNumberIsNotGiven) {
  RawMesh raw;
  raw.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  raw.triangles = {{{0, 1, 2}}};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  raw.wedges.uv = {{nan, 0.5f}, {0.25f, 0.5f}, {0, 1}};
  raw.wedges.normal = {{0, 0, 1}, {nan, 0, 0}, {0, 0, 1}};
  const IndexedMesh mesh = prepared(raw, 1);
  EXPECT_EQ(mesh.wedges.uv[0], (Vec2f{0, 0}));
  EXPECT_EQ(mesh.wedges.normal[1], (Vec3f{0, 0, 0}));
}

TEST(PrepareWedges, MaterialsMeetAlongSeams) {
  RawMesh raw;
  raw.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  raw.triangles = {{{0, 1, 2}}, {{1, 1, 2}}, {{2, 1, 3}}};
  raw.wedges.material = {0, 1, 2};
  const IndexedMesh mesh = prepared(raw, 1);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.positions.size(), 6u);
  for (const std::uint32_t w : mesh.triangles[0].v) EXPECT_EQ(mesh.wedges.material[w], 0u);
  for (const std::uint32_t w : mesh.triangles[1].v) EXPECT_EQ(mesh.wedges.material[w], 2u);
  EXPECT_TRUE(mesh.wedges.uv.empty());
}

TEST(PrepareWedges, OneMaterialNeedsNoWedges) {
  RawMesh raw;
  raw.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  raw.triangles = {{{0, 1, 2}}, {{2, 1, 3}}};
  raw.wedges.material = {0, 0};
  raw.materials.resize(1);
  const IndexedMesh mesh = prepared(raw, 1);
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_TRUE(mesh.wedges.material.empty());
  EXPECT_EQ(mesh.wedges.materials.size(), 1u);
}

}  // namespace
}  // namespace lodestone
