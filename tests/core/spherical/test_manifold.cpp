// Any triangles become an oriented manifold.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/mesh/clean.h"
#include "core/spherical/topology/manifold.h"
#include "core/spherical/topology/sides.h"
#include "tests/test_meshes.h"

namespace lodestone::spherical {
namespace {

IndexedMesh mesh_of(std::vector<Vec3d> positions, std::vector<Triangle> triangles) {
  return test::normalised(std::move(positions), std::move(triangles));
}

// Points on a helix: no three in a line, no four in a plane.
std::vector<Vec3d> points(std::size_t count) {
  std::vector<Vec3d> result;
  for (std::size_t k = 0; k < count; ++k) {
    const auto at = static_cast<double>(k);
    result.push_back({std::cos(1.3 * at), std::sin(1.3 * at), 0.1 * at * at});
  }
  return result;
}

// An edge is halved where there is another one between its ends, which is left whole, or where two triangles share all
// their sides.
void expect_reason_for_halving(const Surface& surface, const IndexedMesh& mesh,
                               const std::set<std::pair<Id, Id>>& sides, Id middle) {
  const auto [a, b] = surface.source_vertex[middle];
  std::vector<Id> ends;
  std::set<Triangle, bool (*)(const Triangle&, const Triangle&)> around(
      [](const Triangle& s, const Triangle& t) { return s.v < t.v; });
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& v = surface.triangles[t].v;
    if (std::ranges::find(v, middle) == v.end()) continue;
    Triangle source = mesh.triangles[surface.source_triangle[t]];
    std::ranges::sort(source.v);
    around.insert(source);
    for (const Id corner : v) {
      const SourceVertex of = surface.source_vertex[corner];
      if (!of.is_middle() && (of.a == a || of.a == b) && std::ranges::find(ends, corner) == ends.end())
        ends.push_back(corner);
    }
  }
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_TRUE(sides.contains({ends[0], ends[1]}) || sides.contains({ends[1], ends[0]}) || around.size() == 1);
}

// Checks all that make_manifold promises.
void expect_manifold(const Manifold& manifold, const IndexedMesh& mesh) {
  const Surface& surface = manifold.surface;
  std::set<std::pair<Id, Id>> sides;
  for (const auto& [v] : surface.triangles)
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(sides.insert({v[k], v[(k + 1) % 3]}).second);
  std::uint64_t borders = 0;
  for (const auto& [a, b] : sides) borders += !sides.contains({b, a});
  const SurfaceKind kind = kind_of(surface.triangles, surface.positions.size());
  EXPECT_EQ(kind.open_edges, borders);
  EXPECT_EQ(kind.split_fans, 0u);
  EXPECT_EQ(kind.degenerate, 0u);
  EXPECT_EQ(kind.unused, 0u);
  ASSERT_EQ(surface.source_vertex.size(), surface.positions.size());
  ASSERT_EQ(surface.source_triangle.size(), surface.triangles.size());
  // Each halved edge has a middle of its own between vertices of the input.
  EXPECT_EQ(std::ranges::count_if(surface.source_vertex, &SourceVertex::is_middle),
            static_cast<std::ptrdiff_t>(manifold.repairs.split_edges));
  for (std::size_t v = 0; v < surface.positions.size(); ++v) {
    const auto [a, b] = surface.source_vertex[v];
    if (a == no_source) continue;
    EXPECT_EQ(surface.positions[v], 0.5 * (to_double(mesh.positions[a]) + to_double(mesh.positions[b])));
    if (surface.source_vertex[v].is_middle()) expect_reason_for_halving(surface, mesh, sides, static_cast<Id>(v));
  }
  std::set<Id> sources(surface.source_triangle.begin(), surface.source_triangle.end());
  EXPECT_EQ(sources.size(), mesh.triangles.size());  // none is lost
}

TEST(Manifold, AManifoldRemainsAsItIs) {
  for (const IndexedMesh& mesh : {test::sphere_mesh(3), test::terrain_mesh(5), test::torus_mesh(8, 5)}) {
    const Manifold manifold = make_manifold(mesh);
    expect_manifold(manifold, mesh);
    EXPECT_EQ(manifold.repairs, ManifoldRepairs{});
    EXPECT_EQ(manifold.surface.positions.size(), mesh.positions.size());
    EXPECT_EQ(manifold.surface.triangles.size(), mesh.triangles.size());
  }
}

TEST(Manifold, WedgesOfAPositionAreOneVertex) {
  IndexedMesh mesh = test::sphere_mesh(1);
  const auto count = static_cast<Id>(mesh.positions.size());
  for (Id v = 0; v < count; ++v) mesh.wedges.vertex.push_back(v);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 2)  // every second triangle has wedges of its own
    for (Id& v : mesh.triangles[t].v) {
      mesh.positions.push_back(mesh.positions[v]);
      mesh.wedges.vertex.push_back(v);
      v = static_cast<Id>(mesh.positions.size() - 1);
    }
  const Manifold manifold = make_manifold(mesh);
  EXPECT_TRUE(is_sphere(manifold.surface));
  EXPECT_EQ(manifold.surface.positions.size(), count);
  EXPECT_EQ(manifold.repairs, ManifoldRepairs{});
}

TEST(Manifold, SolidsThatShareAnEdgeAreTakenApart) {
  // Two tetrahedra at the edge (0, 1).
  const IndexedMesh mesh =
      mesh_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}},
              {{{1, 0, 2}}, {{0, 1, 3}}, {{2, 0, 3}}, {{3, 1, 2}}, {{1, 0, 4}}, {{0, 1, 5}}, {{4, 0, 5}}, {{5, 1, 4}}});
  const Manifold manifold = make_manifold(mesh);
  expect_manifold(manifold, mesh);
  EXPECT_EQ(manifold.repairs, (ManifoldRepairs{.nonmanifold_edges = 1, .pinched_vertices = 2, .vertex_copies = 2}));
  EXPECT_EQ(kind_of(manifold.surface.triangles, 8), (SurfaceKind{.components = 2, .euler = 4}));
}

TEST(Manifold, AnEdgeOfThreeTrianglesKeepsAPair) {
  const IndexedMesh mesh = mesh_of(points(5), {{{0, 1, 2}}, {{1, 0, 3}}, {{0, 1, 4}}});
  const Manifold manifold = make_manifold(mesh);
  expect_manifold(manifold, mesh);
  EXPECT_EQ(manifold.repairs.nonmanifold_edges, 1u);
  EXPECT_EQ(manifold.repairs.vertex_copies, 2u);
  EXPECT_EQ(kind_of(manifold.surface.triangles, 7), (SurfaceKind{.components = 2, .euler = 2, .open_edges = 7}));
}

TEST(Manifold, FansThatMeetInAVertexAreTakenApart) {
  const IndexedMesh mesh = mesh_of(points(7), {{{0, 1, 2}}, {{0, 3, 4}}, {{0, 5, 6}}});
  const Manifold manifold = make_manifold(mesh);
  expect_manifold(manifold, mesh);
  EXPECT_EQ(manifold.repairs, (ManifoldRepairs{.pinched_vertices = 1, .vertex_copies = 2}));
}

TEST(Manifold, TheFewerTrianglesAreTurned) {
  IndexedMesh mesh = test::sphere_mesh(2);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) std::swap(mesh.triangles[t].v[0], mesh.triangles[t].v[1]);
  const Manifold manifold = make_manifold(mesh);
  EXPECT_TRUE(is_sphere(manifold.surface));
  EXPECT_EQ(manifold.repairs.turned_triangles, (mesh.triangles.size() + 2) / 3);
  const auto& turned_back = manifold.surface.triangles[0].v;
  EXPECT_EQ(manifold.surface.source_triangle[0], 0u);
  const IndexedMesh before = test::sphere_mesh(2);
  const Triangle expected = canonical(before.triangles[0]);
  const auto& source = manifold.surface.source_vertex;
  EXPECT_EQ(canonical({{source[turned_back[0]].a, source[turned_back[1]].a, source[turned_back[2]].a}}), expected);
}

TEST(Manifold, AMoebiusStripIsCutAcross) {
  std::vector<Triangle> triangles;
  constexpr Id n = 12;  // quads from (2 k, 2 k + 1) to the next pair, the last one swapped
  for (Id k = 0; k < n; ++k) {
    const Id a = 2 * k, b = a + 1, c = k + 1 < n ? a + 2 : 1, d = k + 1 < n ? a + 3 : 0;
    triangles.push_back({{a, c, b}});
    triangles.push_back({{b, c, d}});
  }
  const IndexedMesh mesh = mesh_of(points(2 * n), triangles);
  const Manifold manifold = make_manifold(mesh);
  expect_manifold(manifold, mesh);
  EXPECT_EQ(manifold.repairs.clashing_edges, 1u);
  EXPECT_EQ(kind_of(manifold.surface.triangles, manifold.surface.positions.size()).euler, 1);  // a disk
}

TEST(Manifold, TwoSidesOfATriangleGetAnInside) {
  const IndexedMesh mesh = mesh_of(points(3), {{{0, 1, 2}}, {{0, 2, 1}}});
  const Manifold manifold = make_manifold(mesh);
  expect_manifold(manifold, mesh);
  EXPECT_EQ(manifold.repairs.split_edges, 3u);
  EXPECT_TRUE(is_sphere(manifold.surface));
}

// Random triangles on few vertices: everything that can be wrong, at once.
TEST(Manifold, AnyTrianglesBecomeOne) {
  std::mt19937 engine(7);
  const auto random = [&] { return static_cast<Id>(engine()); };
  std::uint64_t split = 0, clashing = 0;
  for (int round = 0; round < 200; ++round) {
    const Id count = 4 + random() % 9;
    RawMesh raw;
    raw.positions = points(count);
    for (Id t = 0; t < 3 + random() % 60; ++t)
      raw.triangles.push_back({{random() % count, random() % count, random() % count}});
    raw.triangles.push_back({{0, 1, 2}});
    Repairs repairs;
    const IndexedMesh mesh = clean_mesh(raw, repairs);
    const Manifold manifold = make_manifold(mesh);
    expect_manifold(manifold, mesh);
    split += manifold.repairs.split_edges;
    clashing += manifold.repairs.clashing_edges;
  }
  EXPECT_GT(split, 0u);
  EXPECT_GT(clashing, 0u);
}

}  // namespace
}  // namespace lodestone::spherical
