// How a hierarchy is cut into groups that fit storage blocks. Needs no OpenGL.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/base/error.h"
#include "render/backends/gl/gl_groups.h"
#include "tests/render/small_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

const Hierarchy& surface() {
  static const SmallHierarchy made = small_hierarchy(torus_mesh(96, 48), 4);
  return made.hierarchy;
}

std::uint64_t largest_pair() {
  std::uint64_t largest = 0;
  for (const Cell& cell : surface().cells)
    largest = std::max<std::uint64_t>(
        largest, cell.positions.size() + (cell.parent == no_cell ? 0 : surface().cells[cell.parent].positions.size()));
  return largest;
}

TEST(GlGroups, OneGroupWhereEverythingFits) {
  const CellGroups plan = plan_groups(surface(), 1'000'000);
  ASSERT_EQ(plan.groups.size(), 1u);
  EXPECT_EQ(plan.groups[0].cells.size(), surface().cells.size());
  EXPECT_TRUE(plan.groups[0].halo.empty());
}

TEST(GlGroups, NoGroupOfNothing) { EXPECT_TRUE(plan_groups(Hierarchy{}, 100).groups.empty()); }

// Lays every group out again, cell by cell, and looks each place up.
TEST(GlGroups, EveryCellOnceAndItsParentInTheSameGroup) {
  for (const std::uint64_t limit : {largest_pair(), 2 * largest_pair(), 5 * largest_pair()}) {
    const CellGroups plan = plan_groups(surface(), limit);
    EXPECT_GT(plan.groups.size(), 1u);
    std::vector<int> seen(surface().cells.size(), 0);
    for (std::uint32_t g = 0; g < plan.groups.size(); ++g) {
      const CellGroup& group = plan.groups[g];
      std::map<std::uint32_t, std::uint64_t> first_vertex;
      std::uint64_t vertices = 0, indices = 0;
      for (const std::uint32_t cell : group.cells) {
        ++seen[cell];
        EXPECT_EQ(plan.places[cell].group, g);
        EXPECT_EQ(plan.places[cell].first_vertex, vertices);
        EXPECT_EQ(plan.places[cell].first_index, indices);
        first_vertex[cell] = vertices;
        vertices += surface().cells[cell].positions.size();
        indices += 3 * surface().cells[cell].triangles.size();
      }
      for (const std::uint32_t cell : group.halo) {
        EXPECT_TRUE(first_vertex.try_emplace(cell, vertices).second) << "twice in a group";
        vertices += surface().cells[cell].positions.size();
      }
      EXPECT_EQ(group.vertices, vertices);
      EXPECT_EQ(group.indices, indices);
      EXPECT_LE(vertices, limit);
      EXPECT_LE(group.halo.size(), static_cast<std::size_t>(surface().finest()));
      for (const std::uint32_t cell : group.cells)
        if (surface().cells[cell].parent != no_cell) {
          ASSERT_TRUE(first_vertex.count(surface().cells[cell].parent));
          EXPECT_EQ(plan.places[cell].parent_first_vertex, first_vertex[surface().cells[cell].parent]);
        }
    }
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int times) { return times == 1; }));
  }
}

TEST(GlGroups, ACellThatFitsNowhereIsRefused) {
  EXPECT_NO_THROW((void)plan_groups(surface(), largest_pair()));
  EXPECT_THROW((void)plan_groups(surface(), largest_pair() - 1), ResourceError);
}

}  // namespace
}  // namespace lodestone
