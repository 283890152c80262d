// Cutting a mesh on the sphere open: what lies where, and that it is one disc that fills the square.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/base/error.h"
#include "core/spherical/octahedron/unfold.h"
#include "tests/core/spherical/sphere_checks.h"

namespace lodestone::spherical {
namespace {

// As seen with t running down.
double signed_area(const Unfolding& cut, const Triangle& corners) {
  const SquarePoint a = cut.place[corners.v[0]], b = cut.place[corners.v[1]], c = cut.place[corners.v[2]];
  return 0.5 * ((c.s - a.s) * (b.t - a.t) - (b.s - a.s) * (c.t - a.t));
}

void expect_is_subdivision(const test::SphereMesh& mesh, const Unfolding& cut) {
  const std::size_t given = mesh.directions.size();
  ASSERT_EQ(cut.directions.size(), given + cut.added.size());
  for (std::size_t k = 0; k < cut.added.size(); ++k) {
    Vec3d sum{};
    double weights = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_GE(cut.added[k].weight[c], 0);
      weights += cut.added[k].weight[c];
      sum = sum + cut.added[k].weight[c] * mesh.directions[cut.added[k].corner[c]];
    }
    EXPECT_NEAR(weights, 1, 1e-14);
    EXPECT_LT(length((1 / length(sum)) * sum - cut.directions[given + k]), 1e-12);
  }
  // The parts of a flat triangle have its area.
  const auto flat = [&](std::uint32_t v) {
    if (v < given) return mesh.directions[v];
    const AddedVertex& a = cut.added[v - given];
    return a.weight[0] * mesh.directions[a.corner[0]] + a.weight[1] * mesh.directions[a.corner[1]] +
           a.weight[2] * mesh.directions[a.corner[2]];
  };
  std::vector<Vec3d> area(mesh.triangles.size());
  for (std::size_t t = 0; t < cut.triangles.size(); ++t) {
    const auto& v = cut.triangles[t].v;
    area[cut.source[t]] = area[cut.source[t]] + cross(flat(v[1]) - flat(v[0]), flat(v[2]) - flat(v[0]));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t].v;
    const Vec3d whole =
        cross(mesh.directions[v[1]] - mesh.directions[v[0]], mesh.directions[v[2]] - mesh.directions[v[0]]);
    EXPECT_LT(length(whole - area[t]), 1e-12);
  }
}

void expect_is_disc(const Unfolding& cut) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;  // +1 for one direction, -1 for the other
  double area = 0;
  for (std::size_t t = 0; t < cut.triangles.size(); ++t) {
    area += signed_area(cut, cut.corners[t]);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(cut.vertex[cut.corners[t].v[k]], cut.triangles[t].v[k]);
      const std::uint32_t a = cut.corners[t].v[k], b = cut.corners[t].v[(k + 1) % 3];
      edges[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  // Edges that only one triangle uses are on the sides of the square.
  for (const auto& [edge, balance] : edges) {
    if (balance == 0) continue;
    const SquarePoint a = cut.place[edge.first], b = cut.place[edge.second];
    EXPECT_TRUE((a.s == b.s && (a.s == 0 || a.s == 1)) || (a.t == b.t && (a.t == 0 || a.t == 1)));
  }
  EXPECT_NEAR(area, 1, 1e-12);
  EXPECT_EQ(cut.vertex.size() + cut.triangles.size(), edges.size() + 1);  // Euler's number of a disc
}

void expect_copies_are_copies(const Unfolding& cut) {
  EXPECT_TRUE(std::ranges::is_sorted(cut.vertex));
  for (std::size_t w = 0; w < cut.vertex.size(); ++w)
    EXPECT_LT(length(direction_of(cut.place[w]) - cut.directions[cut.vertex[w]]), 1e-14);
  std::map<std::uint32_t, std::uint32_t> count;
  for (const std::uint32_t v : cut.vertex) ++count[v];
  std::erase_if(count, [](const auto& of) { return of.second < 2; });
  ASSERT_EQ(count.size(), cut.cut.size());
  std::size_t poles = 0;
  for (const CutVertex& c : cut.cut) {
    EXPECT_EQ(count[c.vertex], c.count);
    EXPECT_EQ(cut.vertex[c.first], c.vertex);
    EXPECT_EQ(cut.vertex[c.first + c.count - 1], c.vertex);
    poles += c.count == 4;
    if (c.count != 2) continue;
    const SquarePoint a = cut.place[c.first], b = cut.place[c.first + 1];
    EXPECT_TRUE((a.s == b.s && a.t == 1 - b.t && (a.s == 0 || a.s == 1)) ||
                (a.t == b.t && a.s == 1 - b.s && (a.t == 0 || a.t == 1)));
  }
  EXPECT_EQ(poles, 1u);
}

void expect_unfolds(const test::SphereMesh& mesh, double most_bend = 1) {
  const Unfolding cut = unfold(mesh.triangles, mesh.directions, most_bend);
  expect_is_subdivision(mesh, cut);
  expect_is_disc(cut);
  expect_copies_are_copies(cut);
}

TEST(Unfold, AnOctahedronInPlaceNeedsNoSplit) {
  const test::SphereMesh mesh = test::octahedron_on_sphere(0);
  const Unfolding cut = unfold(mesh.triangles, mesh.directions);
  EXPECT_TRUE(cut.added.empty());
  EXPECT_EQ(cut.vertex.size(), 9u);
  EXPECT_EQ(cut.cut.size(), 1u);
  expect_unfolds(mesh);
  expect_unfolds(test::octahedron_on_sphere(3));
}

TEST(Unfold, AnyRotationGivesADiscThatFillsTheSquare) {
  test::Numbers number(7);
  for (int k = 0; k < 60; ++k) {
    test::SphereMesh mesh = k % 2 == 0 ? test::tetrahedron_on_sphere(k / 2 % 5) : test::octahedron_on_sphere(k / 2 % 4);
    rotate(mesh, number.rotation());
    expect_unfolds(mesh);
  }
}

// Rotations by an eighth of a turn put arcs through vertices, along edges and across their middles, within rounding.
TEST(Unfold, ArcsMayMeetVerticesAndEdges) {
  const double h = std::sqrt(0.5);
  for (const Affine3d& turn :
       {Affine3d{{Vec3d{h, h, 0}, {-h, h, 0}, {0, 0, 1}}, {}}, Affine3d{{Vec3d{1, 0, 0}, {0, h, h}, {0, -h, h}}, {}},
        Affine3d{{Vec3d{h, 0, -h}, {0, 1, 0}, {h, 0, h}}, {}}})
    for (const int subdivisions : {0, 1, 2, 3})
      for (const bool tetrahedron : {false, true}) {
        test::SphereMesh mesh =
            tetrahedron ? test::tetrahedron_on_sphere(subdivisions) : test::octahedron_on_sphere(subdivisions);
        expect_unfolds(mesh);
        rotate(mesh, turn);
        expect_unfolds(mesh);
      }
}

TEST(Unfold, TrianglesKeepTheirOrientationInTheSquare) {
  test::Numbers number(5);
  for (int k = 0; k < 5; ++k) {
    test::SphereMesh mesh = test::octahedron_on_sphere(5);
    rotate(mesh, number.rotation());
    const Unfolding cut = unfold(mesh.triangles, mesh.directions);
    for (const Triangle& corners : cut.corners) EXPECT_GT(signed_area(cut, corners), 0);
  }
}

TEST(Unfold, SplitsOnlyTrianglesThatTheArcsCross) {
  test::SphereMesh mesh = test::octahedron_on_sphere(6);
  rotate(mesh, test::Numbers(2).rotation());
  const Unfolding cut = unfold(mesh.triangles, mesh.directions);
  // Four quarter circles cross about as many edges as there are edges along them, times two.
  EXPECT_LT(cut.added.size(), 4u * 64 * 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (cut.triangles[t] == mesh.triangles[t]) continue;
    double top = -1;
    for (const std::uint32_t v : mesh.triangles[t].v) top = std::min(std::max(top, mesh.directions[v].z), 0.5);
    EXPECT_LT(top, 0.05);
  }
}

// The greatest distance, on the sphere, between the middle of an edge as it is drawn and as the image has it.
double greatest_bend(const Unfolding& cut) {
  double greatest = 0;
  for (std::size_t t = 0; t < cut.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const SquarePoint p = cut.place[cut.corners[t].v[k]], q = cut.place[cut.corners[t].v[next]];
      const Vec3d sum = cut.directions[cut.triangles[t].v[k]] + cut.directions[cut.triangles[t].v[next]];
      const Vec3d drawn = direction_of({(p.s + q.s) / 2, (p.t + q.t) / 2});
      greatest = std::max(greatest, length(drawn - (1 / length(sum)) * sum));
    }
  return greatest;
}

TEST(Unfold, LongEdgesAreDrawnWhereTheImageHasThem) {
  test::Numbers number(7);
  for (int k = 0; k < 5; ++k) {
    test::SphereMesh mesh = test::octahedron_on_sphere(1);
    rotate(mesh, number.rotation());
    EXPECT_GT(greatest_bend(unfold(mesh.triangles, mesh.directions)), 0.1);
    EXPECT_LT(greatest_bend(unfold(mesh.triangles, mesh.directions, 1.0 / 64)), 0.08);
    expect_unfolds(mesh, 1.0 / 64);
  }
  // However many are bent.
  const test::SphereMesh fine = test::octahedron_on_sphere(4);
  const std::size_t before = unfold(fine.triangles, fine.directions).triangles.size();
  EXPECT_LT(unfold(fine.triangles, fine.directions, 1e-6).triangles.size(), 4 * before + 4 * 256);
  expect_unfolds(fine, 1e-6);
}

TEST(Unfold, ASurfaceThatDoesNotCoverTheSphereIsRefused) {
  test::SphereMesh mesh = test::octahedron_on_sphere(1);
  mesh.triangles.resize(4);
  EXPECT_THROW((void)unfold(mesh.triangles, mesh.directions), InputError);
  EXPECT_THROW((void)unfold({}, {}), InputError);
}

}  // namespace
}  // namespace lodestone::spherical
