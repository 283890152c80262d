// Borders of meshes and the handles that follow from them: kept up while triangles come and go, against slow twins.
#include <gtest/gtest.h>

#include <random>

#include "core/mesh/raw_mesh.h"
#include "render/reconstruct/finish/label_parts.h"
#include "tests/render/reconstruct/edit_meshes.h"
#include "tests/test_meshes.h"

namespace lodestone::test {
namespace {

constexpr TriangleId none = EditMesh::none;

TEST(CountHandles, OfKnownSurfaces) {
  EXPECT_EQ(count_handles(sphere_mesh(2)), 0u);
  EXPECT_EQ(count_handles(terrain_mesh(5)), 0u);
  IndexedMesh torus = torus_mesh(12, 8);
  EXPECT_EQ(count_handles(torus), 1u);
  torus.triangles.pop_back();  // a hole is not a handle
  EXPECT_EQ(count_handles(torus), 1u);
  EXPECT_EQ(count_handles(touching(torus_mesh(12, 8))), 2u);
  EXPECT_EQ(count_handles(mesh_of({}, 0)), 0u);
  EXPECT_EQ(count_handles(mesh_of({{{0, 1, 2}}, {{0, 1, 3}}}, 4)), std::nullopt);               // facing both ways
  EXPECT_EQ(count_handles(mesh_of({{{0, 1, 2}}, {{1, 0, 3}}, {{1, 0, 4}}}, 5)), std::nullopt);  // three at an edge
}

// In a fan of so many triangles no step may look at all of them for each one.
TEST(CountHandles, TakesAFanOfAnySize) {
  constexpr std::uint32_t n = 100'000;
  std::vector<Triangle> wheel;
  for (std::uint32_t k = 0; k < n; ++k) wheel.push_back({{0, 1 + k, 1 + (k + 1) % n}});
  EXPECT_EQ(count_handles(mesh_of(wheel, n + 1)), 0u);
  EditMesh mesh(n + 1, wheel);
  EXPECT_EQ(mesh.fan(VertexId(0), TriangleId(7)).size(), n);
  for (std::uint32_t t = n - 1; t > 0; --t) mesh.remove(TriangleId(t));
  EXPECT_EQ(mesh.around(VertexId(0)).size(), 1u);
}

TEST(EditMesh, FindsWhatASetOfTrianglesHolds) {
  std::mt19937 random(3);
  EditMesh mesh(9, {{{0, 1, 2}}, {{2, 1, 3}}});
  std::map<TriangleId, Triangle> twin{{TriangleId(0), {{0, 1, 2}}}, {TriangleId(1), {{2, 1, 3}}}};
  const auto at = [&](VertexId a, VertexId b) {
    for (const auto& [t, triangle] : twin)
      for (std::size_t k = 0; k < 3; ++k)
        if (triangle.v[k] == a && triangle.v[(k + 1) % 3] == b) return t;
    return none;
  };
  const auto any = [&] { return VertexId(random() % mesh.vertex_count()); };
  for (int step = 0; step < 4000; ++step) {
    const VertexId a = any(), b = any(), c = any();
    if (step % 3 == 0) {
      const TriangleId t = mesh.at(a, b);
      ASSERT_EQ(t, at(a, b));
      if (t == none) continue;
      mesh.remove(t);
      twin.erase(t);
    } else if (step % 50 == 1 && mesh.vertex_count() < 30) {
      const VertexId own = mesh.add_vertex();
      if (mesh.around(a).empty()) continue;
      const TriangleId t = mesh.around(a).front();
      mesh.move_corner(t, a, own);
      for (std::uint32_t& v : twin[t].v)
        if (v == a) v = own;
    } else {
      const bool fits = a != b && b != c && c != a && at(a, b) == none && at(b, c) == none && at(c, a) == none;
      const TriangleId t = mesh.add(a, b, c);
      ASSERT_EQ(t != none, fits);
      if (fits) twin[t] = {{a, b, c}};
    }
    for (VertexId v{0}; v < mesh.vertex_count(); ++v) {
      std::set<TriangleId> expected;
      for (const auto& [t, triangle] : twin)
        if (std::find(triangle.v.begin(), triangle.v.end(), v) != triangle.v.end()) expected.insert(t);
      const auto around = mesh.around(v);
      ASSERT_EQ(std::set<TriangleId>(around.begin(), around.end()), expected);
    }
  }
}

TEST(BorderLoops, CountTheHandlesThatEulersFormulaGives) {
  std::mt19937 random(11);
  for (int round = 0; round < 40; ++round) {
    const std::uint32_t pieces = 2 + static_cast<std::uint32_t>(round) % 6;
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> piece;
    for (std::uint32_t k = 0; k < pieces; ++k) triangles.push_back({{3 * k, 3 * k + 1, 3 * k + 2}}), piece.push_back(k);
    EditMesh mesh(3 * pieces, triangles);
    BorderLoops borders = borders_of(mesh, piece, pieces);
    std::size_t predicted = 0;
    for (int step = 0; step < 400; ++step) {
      const BorderEdgeId e(random() % borders.edge_count());
      const VertexId c(random() % mesh.vertex_count());
      if (!borders.alive(e) || borders.first(c) == BorderLoops::none) continue;
      const auto [a, b] = std::pair(borders.edge(e).from, borders.edge(e).to);
      if (c == a || c == b || mesh.at(a, c) != none || mesh.at(c, b) != none) continue;
      const bool handle = borders.makes_handle(e, c);
      if (round % 2 == 0 && handle) continue;
      predicted += handle;
      ASSERT_NE(mesh.add(b, a, c), none);
      borders.add_triangle(e, c);
      expect_borders_of(borders, mesh);
      ASSERT_EQ(borders.handles(), count_handles(mesh_of(triangles_of(mesh), mesh.vertex_count())));
      ASSERT_LE(borders.handles(), predicted);
    }
    if (round % 2 == 0) {
      EXPECT_EQ(borders.handles(), 0u);
    }
  }
}

// A comb of needles side by side, far closer than the spacing: what is kept follows the area that they are in, and
// every place of the border has a point near it that faces as it does.
TEST(BorderPoints, FollowTheSpaceOfCrowdedEdges) {
  constexpr std::uint32_t needles = 2000;
  constexpr double spacing = 0.05;
  IndexedMesh mesh;
  for (std::uint32_t k = 0; k < needles; ++k) {
    const float x = static_cast<float>(k) / needles;
    for (const Vec3f& p : {Vec3f{x, 0, 0}, Vec3f{x + 0.5f / needles, 0, 0}, Vec3f{x, 1, 0}})
      mesh.positions.push_back(p);
    mesh.triangles.push_back({{3 * k, 3 * k + 1, 3 * k + 2}});
  }
  const std::vector<LoneEdge> border = border_edges(mesh);
  ASSERT_EQ(border.size(), 3 * needles);
  const std::vector<BorderPoint> points = border_points(mesh, border, spacing);
  EXPECT_LT(points.size(), 16 / (spacing * spacing));
  for (const LoneEdge& edge : border) {
    const auto& v = mesh.triangles[edge.triangle].v;
    const Vec3f a = mesh.positions[v[edge.corner]], b = mesh.positions[v[(edge.corner + 1) % 3]],
                c = mesh.positions[v[(edge.corner + 2) % 3]];
    const Vec3f outward = unit_normal(to_double(cross(b - a, cross(b - a, c - a)))), middle = 0.5f * (a + b);
    EXPECT_TRUE(std::ranges::any_of(points, [&](const BorderPoint& p) {
      return length(p.position - middle) <= 1.0001 * spacing && dot(p.outward, outward) >= 0.9f;
    })) << edge.triangle;
  }
}

}  // namespace
}  // namespace lodestone::test
