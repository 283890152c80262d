// A level as one mesh: the finest is the input, the others are its images, and shared vertices are one again.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>

#include "core/base/error.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/spatial/mesh_distance.h"
#include "tests/core/hierarchy/lattice_meshes.h"

namespace lodestone {
namespace {

using Point = std::tuple<double, double, double>;
using Corners = std::array<Point, 3>;

template <typename PositionOf>
std::vector<Corners> sorted_corners(const std::vector<Triangle>& triangles, PositionOf&& position) {
  std::vector<Corners> result;
  for (const Triangle& t : triangles) {
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d p = position(t.v[i]);
      corners[i] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    result.push_back(corners);
  }
  std::sort(result.begin(), result.end());
  return result;
}

TEST(LevelMesh, GivesTheInputBackAtTheFinestLevel) {
  const IndexedMesh mesh = test::bumpy_sphere(4, true);
  const RawMesh level = level_mesh(test::naive_hierarchy(mesh, 2, 0.2f).hierarchy, 2);
  EXPECT_EQ(level.positions.size(), mesh.positions.size());
  EXPECT_EQ(
      sorted_corners(level.triangles, [&](std::uint32_t v) { return level.positions[v]; }),
      sorted_corners(mesh.triangles, [&](std::uint32_t v) { return mesh.transform.to_model(mesh.positions[v]); }));
}

TEST(LevelMesh, IsWeldedAndUsesEveryVertex) {
  const Hierarchy h = test::naive_hierarchy(test::bumpy_sphere(5), 2, 0.3f).hierarchy;
  for (int l = 0; l <= h.finest(); ++l) {
    const RawMesh mesh = level_mesh(h, l);
    EXPECT_EQ(mesh.triangles.size(), h.levels[static_cast<std::size_t>(l)].triangles);
    std::set<std::uint32_t> used;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
    for (const Triangle& t : mesh.triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        used.insert(t.v[i]);
        ++balance[{t.v[i], t.v[(i + 1) % 3]}];
        --balance[{t.v[(i + 1) % 3], t.v[i]}];
      }
    EXPECT_EQ(used.size(), mesh.positions.size());
    // The image of a closed surface has no boundary: every half-edge has its opposite.
    for (const auto& [edge, sum] : balance) EXPECT_EQ(sum, 0) << "level " << l;
  }
}

TEST(LevelMesh, StaysWithinTheStoredErrorOfTheInput) {
  const Hierarchy h = test::naive_hierarchy(test::bumpy_sphere(5), 2, 0.6f).hierarchy;
  const RawMesh input = level_mesh(h, 2);
  for (int l = 0; l < 2; ++l) {
    const MeshDistance distance = compare_meshes(level_mesh(h, l), input);
    const Level& level = h.levels[static_cast<std::size_t>(l)];
    EXPECT_GT(distance.forward.max, 0);
    EXPECT_LE(distance.forward.max, h.transform.scale * level.error * cell_size(l)) << "level " << l;
  }
}

TEST(LevelMesh, RefusesLevelsThatAreNotThere) {
  const Hierarchy h = test::naive_hierarchy(test::bumpy_sphere(1), 1, 0.3f).hierarchy;
  EXPECT_THROW((void)level_mesh(h, -1), InputError);
  EXPECT_THROW((void)level_mesh(h, 2), InputError);
}

}  // namespace
}  // namespace lodestone
