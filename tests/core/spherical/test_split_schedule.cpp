// Down to a tetrahedron by connectivity, and up again, level by level.
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "core/math/orientation.h"
#include "core/spherical/parameterize/tetrahedron.h"
#include "tests/core/spherical/ring_surface.h"

namespace lodestone::spherical {
namespace {

using test::neighbours_of;
using test::RingSurface;

// A vertex of 2 n triangles above and one below a ring of n.
IndexedMesh bipyramid(std::uint32_t n) {
  std::vector<Vec3d> p;
  std::vector<Triangle> t;
  for (std::uint32_t i = 0; i < n; ++i) p.push_back({std::cos(6.283185 * i / n), std::sin(6.283185 * i / n), 0});
  p.push_back({0, 0, 1}), p.push_back({0, 0, -1});
  for (std::uint32_t i = 0; i < n; ++i) {
    t.push_back({{i, (i + 1) % n, n}});
    t.push_back({{(i + 1) % n, i, n + 1}});
  }
  return test::normalised(std::move(p), std::move(t));
}

TEST(Tetrahedron, EverySphereEndsAsOne) {
  for (const IndexedMesh& mesh : {test::sphere_mesh(0), test::sphere_mesh(4), bipyramid(3), bipyramid(300)}) {
    RingSurface surface(mesh);
    std::vector<VertexSplit> collapses;
    const std::vector<Id> base = collapse_to_tetrahedron(surface.rings, collapses, surface.arena);
    ASSERT_EQ(base.size(), 4u);
    EXPECT_EQ(collapses.size() + 4, mesh.positions.size());
    std::vector<AlignedPoint4d> directions(mesh.positions.size());
    place_tetrahedron(surface.rings, base, directions);
    for (const Id v : base) {
      const progressive::Ring& ring = surface.rings.ring(v);
      ASSERT_EQ(ring.size, 3u);
      for (std::uint32_t k = 0; k < 3; ++k)
        EXPECT_EQ(orientation(directions[v].point(), directions[ring.ids[k]].point(),
                              directions[ring.ids[ring.next(k)]].point()),
                  1);
    }
  }
}

TEST(Tetrahedron, ATorusDoesNotEndAsOne) {
  RingSurface surface(test::torus_mesh(12, 8));
  std::vector<VertexSplit> collapses;
  EXPECT_GT(collapse_to_tetrahedron(surface.rings, collapses, surface.arena).size(), 4u);
}

TEST(RingMesh, UndoneCollapsesLeaveTheRingsThatWereThere) {
  for (const IndexedMesh& mesh : {test::sphere_mesh(3), bipyramid(100), test::torus_mesh(12, 8)}) {
    RingSurface surface(mesh);
    const auto before = neighbours_of(surface.rings);
    std::vector<VertexSplit> collapses;
    static_cast<void>(collapse_to_tetrahedron(surface.rings, collapses, surface.arena));
    EXPECT_GT(collapses.size(), 50u);
    for (std::size_t k = collapses.size(); k-- > 0;)
      surface.rings.undo(collapses[k].vertex, collapses[k].target, collapses[k].ring, surface.arena);
    EXPECT_EQ(neighbours_of(surface.rings), before);
  }
}

TEST(SplitSchedule, WavesShareNoVertexAndLevelsGrow) {
  constexpr double growth = 1.5;
  RingSurface surface(test::sphere_mesh(4));
  const auto before = neighbours_of(surface.rings);
  std::vector<VertexSplit> collapses;
  static_cast<void>(collapse_to_tetrahedron(surface.rings, collapses, surface.arena));
  const SplitSchedule schedule = make_split_schedule(surface.rings, collapses, growth);
  ASSERT_EQ(schedule.splits.size(), collapses.size());
  ASSERT_EQ(schedule.waves.back(), collapses.size());
  ASSERT_EQ(schedule.levels.back() + 1, schedule.waves.size());
  std::size_t vertices = 4;
  for (std::size_t level = 0; level + 1 < schedule.levels.size(); ++level) {
    for (std::size_t wave = schedule.levels[level]; wave < schedule.levels[level + 1]; ++wave) {
      std::set<Id> touched;
      std::size_t count = 0;
      ASSERT_LT(schedule.waves[wave], schedule.waves[wave + 1]);
      for (std::size_t k = schedule.waves[wave]; k < schedule.waves[wave + 1]; ++k) {
        const VertexSplit& split = schedule.splits[k];
        surface.rings.undo(split.vertex, split.target, split.ring, surface.arena);
        touched.insert(split.vertex);
        const auto ring = surface.rings.ring(split.vertex).neighbours();
        touched.insert(ring.begin(), ring.end());
        count += ring.size() + 1;
      }
      EXPECT_EQ(touched.size(), count);
    }
    const std::size_t after = 4 + schedule.waves[schedule.levels[level + 1]];
    EXPECT_GT(after, vertices);
    EXPECT_LE(static_cast<double>(after), static_cast<double>(vertices) * growth + 2);
    vertices = after;
  }
  EXPECT_EQ(neighbours_of(surface.rings), before);
}

TEST(SplitSchedule, OfATetrahedronIsEmpty) {
  RingSurface surface(bipyramid(3));
  const SplitSchedule schedule = make_split_schedule(surface.rings, {}, 1.3);
  EXPECT_TRUE(schedule.splits.empty());
  EXPECT_EQ(schedule.levels.size(), 1u);
}

}  // namespace
}  // namespace lodestone::spherical
