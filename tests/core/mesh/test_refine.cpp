// Splitting over-long edges: nothing longer is left, the parts tile their triangle, no T-junction opens, and it ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "core/base/error.h"
#include "core/mesh/clean.h"
#include "core/mesh/refine.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

IndexedMesh cleaned(std::vector<Vec3d> positions, std::vector<Triangle> triangles, Lattice lattice = {}) {
  RawMesh raw;
  raw.positions = std::move(positions);
  raw.triangles = std::move(triangles);
  Repairs repairs;
  return clean_mesh(raw, repairs, {}, lattice);
}

double longest_edge(const IndexedMesh& mesh) {
  double longest = 0;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      longest =
          std::max(longest, length(to_double(mesh.positions[t.v[k]]) - to_double(mesh.positions[t.v[(k + 1) % 3]])));
  return longest;
}

Vec3d area_vector(Vec3d a, Vec3d b, Vec3d c) { return 0.5 * cross(b - a, c - a); }

Vec3d area_vector(const IndexedMesh& mesh) {
  Vec3d sum;
  for (const Triangle& t : mesh.triangles)
    sum = sum + area_vector(to_double(mesh.positions[t.v[0]]), to_double(mesh.positions[t.v[1]]),
                            to_double(mesh.positions[t.v[2]]));
  return sum;
}

// Half-edges that no opposite one answers, with multiplicity, by positions: the border of the surface as a chain.
std::map<std::array<float, 6>, int> border(const IndexedMesh& mesh) {
  std::map<std::array<float, 6>, int> chain;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec3f a = mesh.positions[t.v[k]], b = mesh.positions[t.v[(k + 1) % 3]];
      ++chain[{a.x, a.y, a.z, b.x, b.y, b.z}];
      --chain[{b.x, b.y, b.z, a.x, a.y, a.z}];
    }
  std::erase_if(chain, [](const auto& entry) { return entry.second == 0; });
  return chain;
}

double length_of(const std::map<std::array<float, 6>, int>& chain) {
  double sum = 0;
  for (const auto& [e, count] : chain)
    sum += std::abs(count) * length(Vec3d{e[3], e[4], e[5]} - Vec3d{e[0], e[1], e[2]});
  return sum;
}

bool is_clean(const IndexedMesh& mesh) {
  std::set<std::array<float, 3>> places;
  for (const Vec3f p : mesh.positions)
    if (!places.insert({p.x, p.y, p.z}).second) return false;
  std::vector<char> used(mesh.positions.size(), 0);
  std::set<std::array<std::uint32_t, 3>> seen;
  for (const Triangle& t : mesh.triangles) {
    if (is_degenerate(t) || !seen.insert(canonical(t).v).second) return false;
    for (const std::uint32_t v : t.v) used[v] = 1;
  }
  return std::ranges::count(used, 0) == 0;
}

// Every part of one triangle lies in it, turned as it is, and together they have its area: for random triangles of all
// shapes, needles too.
TEST(Refine, TilesATriangle) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(0, 1);
  for (int i = 0; i < 200; ++i) {
    std::vector<Vec3d> p;
    for (int k = 0; k < 3; ++k) p.push_back({place(random), place(random), place(random)});
    if (i % 3 == 0) p[2] = p[1] + 1e-3 * (p[2] - p[0]);  // a needle
    IndexedMesh mesh = cleaned(p, {{{0, 1, 2}}});
    const IndexedMesh before = mesh;
    const Vec3d a = to_double(before.positions[0]), whole = area_vector(before);
    const double longest = 0.04 + 0.2 * place(random);
    const RefineReport report = refine_mesh(mesh, longest);
    EXPECT_LE(longest_edge(mesh), longest);
    EXPECT_TRUE(is_clean(mesh));
    EXPECT_EQ(report.triangles_before, 1u);
    EXPECT_EQ(report.triangles_after, mesh.triangles.size());
    EXPECT_EQ(count_refined(before, longest, 1'000'000), mesh.triangles.size());
    EXPECT_EQ(count_refined(before, longest, 3), std::min<std::size_t>(mesh.triangles.size(), 4));
    double area = 0;
    for (const Triangle& t : mesh.triangles) {
      const Vec3d part = area_vector(to_double(mesh.positions[t.v[0]]), to_double(mesh.positions[t.v[1]]),
                                     to_double(mesh.positions[t.v[2]]));
      area += length(part);
      EXPECT_GT(dot(part, whole), -1e-8) << "not turned";
    }
    EXPECT_NEAR(area, length(whole), 1e-6);
    EXPECT_LT(length(area_vector(mesh) - whole), 1e-6);
    for (const Vec3f p3 : mesh.positions) {
      const Vec3d q = to_double(p3) - a;
      EXPECT_LE(std::abs(dot(q, whole)), 2e-7 * length(whole) + 1e-9) << "in the plane";
    }
    // The border is the triangle's own, in pieces.
    EXPECT_NEAR(length_of(border(mesh)), length_of(border(before)), 1e-6);
  }
}

class RefineOf : public testing::TestWithParam<IndexedMesh (*)()> {};

TEST_P(RefineOf, ASurfaceOpensNoTJunction) {
  const IndexedMesh before = GetParam()();
  for (const double longest : {0.3, 0.11, 0.03}) {
    IndexedMesh mesh = before;
    const RefineReport report = refine_mesh(mesh, longest);
    EXPECT_LE(longest_edge(mesh), longest);
    EXPECT_TRUE(is_clean(mesh));
    EXPECT_EQ(report.triangles_after, mesh.triangles.size());
    // A T-junction would leave edges that the border of the surface had not.
    EXPECT_NEAR(length_of(border(mesh)), length_of(border(before)), 1e-4);
    EXPECT_LT(length(area_vector(mesh) - area_vector(before)), 1e-5);
    IndexedMesh again = mesh;
    EXPECT_EQ(refine_mesh(again, longest).split, 0u);
    EXPECT_EQ(again.triangles, mesh.triangles) << "what is short stays";
  }
}

IndexedMesh box() {
  std::vector<Vec3d> p;
  for (int i = 0; i < 8; ++i) p.push_back({double(i & 1), 0.7 * (i >> 1 & 1), 0.31 * (i >> 2)});
  return cleaned(p, {{{0, 2, 3}},
                     {{0, 3, 1}},
                     {{4, 5, 7}},
                     {{4, 7, 6}},
                     {{0, 1, 5}},
                     {{0, 5, 4}},
                     {{2, 6, 7}},
                     {{2, 7, 3}},
                     {{0, 4, 6}},
                     {{0, 6, 2}},
                     {{1, 3, 7}},
                     {{1, 7, 5}}});
}

// Five fins on one edge, some turned against the others.
IndexedMesh fins() {
  std::vector<Vec3d> p{{0, 0, 0}, {0, 0, 1}};
  std::vector<Triangle> t;
  for (std::uint32_t i = 0; i < 5; ++i) {
    p.push_back({0.5 + 0.4 * std::cos(1.2 * i), 0.4 * std::sin(1.2 * i), 0.2 * i});
    t.push_back(i % 2 ? Triangle{{0, 1, 2 + i}} : Triangle{{1, 0, 2 + i}});
  }
  return cleaned(p, t);
}

// A fan of needles around a point, one edge of the hub far away.
IndexedMesh needles() {
  std::vector<Vec3d> p{{0.5, 0.5, 0}};
  std::vector<Triangle> t;
  for (std::uint32_t i = 0; i <= 60; ++i) {
    p.push_back({0.5 + 0.5 * std::cos(0.1 * i), 0.5 + 0.5 * std::sin(0.1 * i), 0.01 * i});
    if (i > 0) t.push_back({{0, i, i + 1}});
  }
  return cleaned(p, t);
}

INSTANTIATE_TEST_SUITE_P(Meshes, RefineOf,
                         testing::Values(
                             box, fins, needles, [] { return test::torus_mesh(12, 7); },
                             [] { return test::terrain_mesh(6); }),
                         [](const auto& param) { return std::to_string(param.index); });

// A middle that falls on a vertex of the mesh is that vertex: the flat triangle between the two goes, and where the
// surface had a T-junction of its own it has one no more.
TEST(Refine, JoinsMiddlesWithVerticesThatStandThere) {
  // ab is one edge above and two, am and mb, below; the flat triangle abm is between.
  IndexedMesh mesh = cleaned({{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, 0}, {0.5, -0.5, 0}},
                             {{{0, 1, 3}}, {{0, 2, 1}}, {{0, 4, 2}}, {{2, 4, 1}}});
  EXPECT_FALSE(border(mesh).empty());
  refine_mesh(mesh, 0.8);
  EXPECT_TRUE(is_clean(mesh));
  EXPECT_EQ(mesh.positions.size(), 5u);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(border(mesh).size(), 8u) << "the square's four sides, each once either way";

  // Two triangles over each other, one of them cut there already: their halves are the same triangle.
  IndexedMesh over =
      cleaned({{0, 0, 0}, {1, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0}}, {{{0, 1, 2}}, {{0, 3, 2}}, {{3, 1, 2}}});
  refine_mesh(over, 0.8);
  EXPECT_TRUE(is_clean(over));
  EXPECT_EQ(over.triangles.size(), 2u);
}

TEST(Refine, KeepsVerticesOnTheLattice) {
  std::vector<Vec3d> p;
  for (const Vec3f q : box().positions) p.push_back(to_double(q) + Vec3d{0, 0.01 * q.z, 0});
  IndexedMesh mesh = cleaned(p, box().triangles, {10});
  refine_mesh(mesh, 0.1);
  EXPECT_LE(longest_edge(mesh), 0.1);
  EXPECT_TRUE(is_clean(mesh));
  EXPECT_TRUE(border(mesh).empty());
  for (const Vec3f q : mesh.positions) EXPECT_TRUE(Lattice{10}.holds(q));
  EXPECT_THROW((void)refine_mesh(mesh, 0.01), InputError) << "ten steps of the lattice";
}

TEST(Refine, RefusesWhatHasNoArea) {
  IndexedMesh mesh = cleaned({{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}, {{{0, 1, 2}}});
  EXPECT_THROW((void)refine_mesh(mesh, 0.8), InputError);
}

// Two squares that meet along a seam: one chart each, other colours and materials.
IndexedMesh seam() {
  IndexedMesh mesh;
  mesh.positions = {{0, 0, 0}, {0.5f, 0, 0}, {0.5f, 1, 0}, {0, 1, 0}, {0.5f, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.5f, 1, 0}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}, {{4, 5, 6}}, {{4, 6, 7}}};
  mesh.wedges.vertex = {0, 1, 2, 3, 1, 5, 6, 2};
  for (std::size_t w = 0; w < 8; ++w) {
    const Vec3f p = mesh.positions[w];
    const bool right = w >= 4;
    mesh.wedges.uv.push_back({p.x + (right ? 10.0f : 0.0f), p.y});
    mesh.wedges.colour.push_back(
        {static_cast<std::uint8_t>(right ? 200 : 0), 0, static_cast<std::uint8_t>(255 * p.y), 255});
    mesh.wedges.normal.push_back(right ? Vec3f{0, 0, 1} : Vec3f{p.y, 1 - p.y, 0});
    mesh.wedges.material.push_back(right ? 1 : 0);
  }
  return mesh;
}

TEST(Refine, InterpolatesAttributesAndKeepsSeams) {
  IndexedMesh mesh = seam();
  refine_mesh(mesh, 0.2);
  EXPECT_LE(longest_edge(mesh), 0.2);
  const WedgeAttributes& w = mesh.wedges;
  const std::size_t count = mesh.positions.size();
  ASSERT_TRUE(w.vertex.size() == count && w.uv.size() == count && w.colour.size() == count &&
              w.normal.size() == count && w.material.size() == count);
  std::map<std::array<float, 3>, std::uint32_t> first;
  std::size_t on_seam = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3f p = mesh.positions[i];
    const bool right = w.material[i] == 1;
    EXPECT_FLOAT_EQ(w.uv[i].x, p.x + (right ? 10.0f : 0.0f));
    EXPECT_FLOAT_EQ(w.uv[i].y, p.y);
    EXPECT_EQ(w.colour[i].r, right ? 200 : 0);
    EXPECT_NEAR(w.colour[i].b, 255 * p.y, 3);
    EXPECT_NEAR(length(w.normal[i]), 1, 1e-5);
    const auto [at, is_new] = first.try_emplace({p.x, p.y, p.z}, i);
    EXPECT_EQ(w.vertex[i], at->second) << "the first wedge at the place";
    on_seam += !is_new;
  }
  EXPECT_EQ(on_seam, 9u) << "eight parts of the seam";
  for (const Triangle& t : mesh.triangles) {
    EXPECT_EQ(w.material[t.v[0]], w.material[t.v[1]]);
    EXPECT_EQ(w.material[t.v[1]], w.material[t.v[2]]);
  }
}

}  // namespace
}  // namespace lodestone
