// The unpaired half-edges of the finest level, that the chain form of the crack metric starts from.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "experiments/metrics/cracks/crack_basis.h"
#include "tests/experiments/metrics/crack_subject.h"

namespace lodestone {
namespace {

using namespace testing;

std::uint64_t unpaired_count(const IndexedMesh& mesh) { return Subject(mesh).basis->unpaired.size(); }

TEST(CrackBasis, FindsTheBordersOfTheSurface) {
  EXPECT_EQ(unpaired_count(sphere_mesh(12)), 0u);
  EXPECT_EQ(unpaired_count(torus_mesh(16)), 0u);
  EXPECT_EQ(unpaired_count(terrain_mesh(20)), 80u);

  IndexedMesh one;
  one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.triangles = {{{0, 1, 2}}};
  EXPECT_EQ(unpaired_count(one), 3u);
  one.triangles.push_back({{1, 0, 2}});  // the same triangle from behind: all pair off
  EXPECT_EQ(unpaired_count(one), 0u);
}

TEST(CrackBasis, KeepsTheMultiplicityOfNonManifoldEdges) {
  // Four triangles around the edge 0-1, all in the same direction: four unpaired copies of it, in several cells.
  IndexedMesh fan;
  fan.positions = {{0.5f, 0.5f, 0}, {0.5f, 0.5f, 1}, {0, 0, 0.5f}, {1, 0, 0.5f}, {1, 1, 0.5f}, {0, 1, 0.5f}};
  for (std::uint32_t tip = 2; tip < 6; ++tip) fan.triangles.push_back({{0, 1, tip}});
  Subject subject(fan, 1);
  EXPECT_EQ(subject.hierarchy().levels[1].cell_count, 4u);
  EXPECT_EQ(subject.basis->unpaired.size(), 12u);
  for (const bool lambda_one : {false, true}) EXPECT_EQ(open_edges_of_level(subject, 1, lambda_one), 0u);

  fan.triangles[0] = {{1, 0, 2}};  // one the other way round pairs off with one of the three
  EXPECT_EQ(unpaired_count(fan), 10u);
}

TEST(CrackBasis, EqualsThatOfTheDefinition) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    const Subject subject(named.mesh);
    const Hierarchy& h = subject.hierarchy();
    std::multiset<std::array<std::uint32_t, 3>> fast, slow;
    for (CellRank leaf{0}; leaf < h.levels.back().cell_count; ++leaf)
      for (const LocalEdge& e : subject.basis->unpaired_of(leaf))
        fast.insert({h.levels.back().id_of(leaf), e.from, e.to});
    for (const NaiveHalfEdge& e : naive_unpaired(h)) slow.insert({e.cell, e.from, e.to});
    EXPECT_EQ(fast, slow);
  }
}

}  // namespace
}  // namespace lodestone
