// Places of families on the device, as they are added and removed. Needs no OpenGL.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include "core/base/error.h"
#include "render/backends/gl/scene/places.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

const Hierarchy& surface() {
  static const NaiveHierarchy made = naive_hierarchy(torus_mesh(96, 48), 4);
  return made.hierarchy;
}

std::vector<CellId> families() {
  std::vector<CellId> all{no_cell};
  for (CellId c{0}; c < surface().cells.size(); ++c)
    if (surface().cells[c].child_count > 0) all.push_back(c);
  return all;
}

std::uint64_t largest_family() {
  std::uint64_t largest = 0;
  for (const CellId f : families()) largest = std::max(largest, GlPlaces::family_size(surface(), f).vertices);
  return largest;
}

TEST(RangeAllocator, GivesDisjointRangesAndTakesThemBack) {
  std::mt19937 random(1);
  constexpr std::uint64_t slots = 500;
  RangeAllocator allocator(slots);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> held;
  std::vector<int> used(slots, 0);
  std::size_t refused = 0;
  for (int i = 0; i < 5000; ++i) {
    if (random() % 2 == 0 || held.empty()) {
      const std::uint64_t count = 1 + random() % 60;
      const auto first = allocator.allocate(count);
      // Refused only where no run of so many free slots is left: the slow way to see that.
      std::uint64_t run = 0, longest = 0;
      for (const int u : used) run = u ? 0 : run + 1, longest = std::max(longest, run);
      ASSERT_EQ(first.has_value(), longest >= count);
      if (!first) {
        ++refused;
        continue;
      }
      for (std::uint64_t s = *first; s < *first + count; ++s) ASSERT_EQ(used.at(s)++, 0);
      held.emplace_back(*first, count);
    } else {
      const std::size_t k = random() % held.size();
      const auto [first, count] = held[k];
      allocator.release(first, count);
      for (std::uint64_t s = first; s < first + count; ++s) --used[s];
      held.erase(held.begin() + static_cast<std::ptrdiff_t>(k));
    }
    ASSERT_EQ(allocator.free_slots(), static_cast<std::uint64_t>(std::count(used.begin(), used.end(), 0)));
  }
  EXPECT_GT(refused, 10u);
  for (const auto& [first, count] : held) allocator.release(first, count);
  EXPECT_EQ(allocator.allocate(slots), std::optional<std::uint64_t>(0));
}

// Families at random, each cell's vertices and indices in slots of their own, and the parent's copy before them.
TEST(GlPlaces, FamiliesComeAndGoWithoutOverlap) {
  std::mt19937 random(2);
  for (const std::uint64_t limit : {largest_family(), 3 * largest_family(), std::uint64_t{1'000'000}}) {
    GlPlaces places({&surface()}, limit, {});
    std::map<CellId, FamilyPlace> there;
    for (int i = 0; i < 600; ++i) {
      const CellId family = families()[random() % families().size()];
      if (there.contains(family)) {
        places.remove({0, family});
        there.erase(family);
        continue;
      }
      there[family] = places.add({0, family});
      std::vector<std::vector<char>> vertices, indices;
      for (const GroupSize group : places.groups()) {
        EXPECT_LE(group.vertices, limit);
        vertices.emplace_back(group.vertices, 0), indices.emplace_back(group.indices, 0);
      }
      const auto take = [](std::vector<char>& slots, std::uint64_t first, std::uint64_t count) {
        for (std::uint64_t s = first; s < first + count; ++s) ASSERT_EQ(slots.at(s)++, 0);
      };
      for (const auto& [parent, place] : there) {
        if (parent != no_cell)
          take(vertices[place.group], place.first_vertex, surface().cells[parent].positions.size());
        const CellId first = parent == no_cell ? CellId(0) : surface().cells[parent].first_child;
        const std::uint32_t count = parent == no_cell ? 1 : surface().cells[parent].child_count;
        for (CellId c = first; c < first + count; ++c) {
          EXPECT_EQ(places.place(0, c).group, place.group);
          EXPECT_EQ(places.place(0, c).parent_first_vertex, place.first_vertex);
          take(vertices[place.group], places.place(0, c).first_vertex, surface().cells[c].positions.size());
          take(indices[place.group], places.place(0, c).first_index, 3 * surface().cells[c].triangles.size());
        }
      }
    }
  }
}

TEST(GlPlaces, OneGroupWhereWhatIsExpectedFits) {
  GroupSize all;
  for (const CellId f : families()) {
    const GroupSize size = GlPlaces::family_size(surface(), f);
    all = {all.vertices + size.vertices, all.indices + size.indices};
  }
  GlPlaces places({&surface()}, all.vertices, {all});
  for (const CellId f : families()) (void)places.add({0, f});
  ASSERT_EQ(places.groups().size(), 1u);
  EXPECT_EQ(places.groups()[0].vertices, all.vertices);
  EXPECT_EQ(places.groups()[0].indices, all.indices);
}

// A model without attributes costs no memory for those of another.
TEST(GlPlaces, GroupsAreForModelsWithTheSameAttributes) {
  Hierarchy coloured = surface(), textured = surface();
  coloured.attributes.colours = true;
  textured.attributes.uv = textured.attributes.wedges = true;
  GlPlaces places({&surface(), &coloured, &textured, &surface(), &coloured}, 1'000'000, {});
  for (std::uint32_t m = 0; m < 5; ++m) {
    const std::uint32_t group = places.add({m, no_cell}).group;
    EXPECT_EQ(group, m % 3);
    EXPECT_EQ(places.attributes(group).colours, m % 3 == 1);
    EXPECT_EQ(places.attributes(group).uv, m % 3 == 2);
  }
  EXPECT_EQ(places.groups().size(), 3u);
}

TEST(GlPlaces, AFamilyThatFitsNowhereIsRefused) {
  const auto add_all = [](std::uint64_t limit) {
    GlPlaces places({&surface()}, limit, {});
    for (const CellId f : families()) (void)places.add({0, f});
  };
  EXPECT_NO_THROW(add_all(largest_family()));
  EXPECT_THROW(add_all(largest_family() - 1), ResourceError);
}

}  // namespace
}  // namespace lodestone
