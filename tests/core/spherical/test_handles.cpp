// Handles are closed along short loops: labels, cuts, and the whole beside its slow twin.
#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <utility>

#include "core/mesh/solids.h"
#include "core/spherical/topology/cycle_labels.h"
#include "core/spherical/topology/fill_holes.h"
#include "core/spherical/topology/handles.h"
#include "core/spherical/topology/manifold.h"
#include "tests/core/spherical/greedy_twin.h"
#include "tests/test_meshes.h"

namespace lodestone::spherical {
namespace {

// Moves the vertices a little, so that no two loops have the same length.
Surface shaken(const IndexedMesh& mesh, std::uint32_t seed = 1) {
  Surface surface = make_manifold(mesh).surface;
  std::mt19937 random(seed);
  const auto number = [&] { return 0.01 * (static_cast<double>(random()) / 4294967295.0 - 0.5); };
  for (Vec3d& p : surface.positions) p = p + Vec3d{number(), number(), number()};
  return surface;
}

double sum(const std::vector<double>& lengths) { return std::accumulate(lengths.begin(), lengths.end(), 0.0); }

std::vector<double> close(Surface& surface, double slack) {
  std::vector<BallSearch> memory(1);
  return close_handles(surface, {slack}, {}, memory, 0).lengths;
}

TEST(XorBasis, ReducesWordsOfItsSpaceToZero) {
  XorBasis basis;
  for (const std::uint64_t word : {0b1100u, 0b1010u, 0b0001u}) basis.add(word);
  EXPECT_EQ(basis.size(), 3u);
  for (const std::uint64_t word : {0b0110u, 0b0111u, 0b1101u}) EXPECT_EQ(basis.reduce(word), 0u);
  EXPECT_NE(basis.reduce(0b1000), 0u);
  EXPECT_NE(basis.reduce(0b10000), 0u);
}

// The labels round every face cancel each other out, but round the last caps leave that of the loop they close.
void expect_labels(const SurfaceGraph& graph, std::uint64_t cut_label = 0) {
  std::vector<std::uint64_t> sums(graph.face_count());
  for (Id v = 0; v < graph.vertex_count(); ++v)
    for (std::size_t k = 0; k < graph.links(v).size(); ++k) {
      const Link& link = graph.links(v)[k];
      sums[graph.face(v, k)] ^= graph.label(link);
      EXPECT_EQ(graph.label(graph.links(link.to)[graph.find(link.to, v)]), graph.label(link));
    }
  for (std::size_t cap = 1; cap <= 2 && cut_label != 0; ++cap)
    EXPECT_EQ(std::exchange(sums[sums.size() - cap], 0), cut_label);
  EXPECT_EQ(std::count(sums.begin(), sums.end(), 0u), static_cast<std::ptrdiff_t>(sums.size()));
}

TEST(CycleLabels, CancelRoundFacesAndNotAlongGenerators) {
  Surface surface = shaken(truss(9, 1));
  SurfaceGraph graph(surface);
  BallSearch search;
  std::mt19937_64 random;
  for (Id genus = 5; genus > 0; --genus) {
    ASSERT_EQ(graph.genus(), genus);
    const Generators generators = label_cycles(graph, search, random);
    EXPECT_EQ(generators.size(), 2 * genus);
    expect_labels(graph);
    XorBasis classes;
    const auto label_of = [&](const std::vector<Id>& loop) {
      std::uint64_t label = 0;
      for (std::size_t k = 0; k < loop.size(); ++k)
        label ^= graph.label(graph.links(loop[k])[graph.find(loop[k], loop[(k + 1) % loop.size()])]);
      return label;
    };
    for (const std::vector<Id>& loop : generators) {
      EXPECT_NE(classes.reduce(label_of(loop)), 0u);
      classes.add(label_of(loop));
    }
    const std::uint64_t label = label_of(generators.front());
    graph.cut(generators.front(), surface);
    expect_labels(graph, label);
  }
  for (const std::vector<Id>& loop : graph.cap_loops()) fill_loop(surface, loop);
  EXPECT_TRUE(is_sphere(surface));
}

TEST(Handles, ASphereRemainsAsItIs) {
  Surface surface = shaken(test::sphere_mesh(2));
  const Surface before = surface;
  EXPECT_TRUE(close(surface, 0.5).empty());
  EXPECT_EQ(surface.triangles, before.triangles);
}

TEST(Handles, TheSmallestTorusIsClosed) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;  // seven vertices, all of them neighbours
  for (Id k = 0; k < 7; ++k) {
    positions.push_back({std::cos(0.9 * k), std::sin(0.9 * k), 0.03 * k * k});
    triangles.push_back({{k, (k + 1) % 7, (k + 3) % 7}});
    triangles.push_back({{k, (k + 3) % 7, (k + 2) % 7}});
  }
  Surface surface = shaken(test::normalised(positions, triangles));
  ASSERT_EQ(kind_of(surface.triangles, 7), (SurfaceKind{.components = 1, .euler = 0}));
  const std::vector<double> greedy = GreedyTwin(surface).close();
  const std::vector<double> lengths = close(surface, 0);
  EXPECT_TRUE(is_sphere(surface));
  ASSERT_EQ(lengths.size(), 1u);
  EXPECT_NEAR(lengths[0], greedy[0], 1e-6);
}

// Without slack the loops are the twin's, one by one; with it, they are about as short.
TEST(Handles, LoopsAreThoseOfTheTwin) {
  const std::vector<IndexedMesh> meshes{test::torus_mesh(12, 7), truss(6, 1), five_rings(8)};
  for (const IndexedMesh& mesh : meshes) {
    const Surface surface = shaken(mesh);
    SCOPED_TRACE(surface.triangles.size());
    const std::vector<double> greedy = GreedyTwin(surface).close();
    Surface exact = surface;
    const std::vector<double> lengths = close(exact, 0);
    EXPECT_TRUE(is_sphere(exact));
    ASSERT_EQ(lengths.size(), greedy.size());
    for (std::size_t k = 0; k < greedy.size(); ++k) EXPECT_NEAR(lengths[k], greedy[k], 1e-5 * greedy[k]) << k;
    for (const double slack : {0.25, 0.5, 1.0}) {
      Surface near = surface;
      EXPECT_LT(sum(close(near, slack)), 1.05 * sum(greedy)) << slack;
      EXPECT_TRUE(is_sphere(near));
    }
  }
}

TEST(Handles, SurfaceKeepsItsTrianglesAndNamesItsSources) {
  const Surface before = shaken(truss(9, 1));
  Surface surface = before;
  std::vector<BallSearch> memory(1);
  const ClosedHandles closed = close_handles(surface, {}, {}, memory, 0);
  ASSERT_EQ(surface.triangles.size(), before.triangles.size() + closed.cap_triangles);
  ASSERT_EQ(surface.source_vertex.size(), surface.positions.size());
  for (std::size_t t = 0; t < before.triangles.size(); ++t) {
    EXPECT_EQ(surface.source_triangle[t], t);
    for (int k = 0; k < 3; ++k) {
      const Id v = surface.triangles[t].v[k];
      EXPECT_EQ(surface.source_vertex[v], before.source_vertex[before.triangles[t].v[k]]);
      EXPECT_EQ(surface.positions[v], before.positions[before.triangles[t].v[k]]);
    }
  }
  for (std::size_t t = before.triangles.size(); t < surface.triangles.size(); ++t)
    EXPECT_EQ(surface.source_triangle[t], no_source);
}

// More generators than a word has bits, and more cuts than one labelling serves.
TEST(Handles, ManyHandlesAreClosed) {
  Surface surface = shaken(truss(48, 4));
  const std::int64_t euler = kind_of(surface.triangles, surface.positions.size()).euler;
  EXPECT_LT(euler, -300);
  EXPECT_EQ(static_cast<std::int64_t>(2 * close(surface, 0.5).size()), 2 - euler);
  EXPECT_TRUE(is_sphere(surface));
}

}  // namespace
}  // namespace lodestone::spherical
