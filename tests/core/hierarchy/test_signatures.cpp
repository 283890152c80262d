// Signatures beside a slow twin: the cells that use a position, looked for one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "core/hierarchy/model/find_signatures.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

using Place = std::array<float, 3>;

Place place_of(Vec3f p) { return {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}; }

// The cells of a level by the positions of their shared vertices.
std::map<Place, std::set<std::uint32_t>> users_of(const Hierarchy& h, int level) {
  std::map<Place, std::set<std::uint32_t>> users;
  for (const Cell& cell : h.cells_of(level))
    for (std::size_t i = cell.first_shared(); i < cell.positions.size(); ++i)
      users[place_of(cell.positions[i])].insert(static_cast<std::uint32_t>(&cell - h.cells.data()));
  return users;
}

std::set<std::uint32_t> parents_of(const Hierarchy& h, std::span<const CellId> cells) {
  std::set<std::uint32_t> parents;
  for (const CellId cell : cells)
    if (h.cells[cell].parent != no_cell) parents.insert(h.cells[cell].parent);
  return parents;
}

// All that must hold whatever has been united: the cells of a signature use it, all copies of a vertex share one, and
// it has at least the cells that use the vertex.
void expect_safe(const Hierarchy& h, const Signatures& signatures, std::size_t most, bool exact) {
  for (int level = 0; level <= h.finest(); ++level) {
    const auto users = users_of(h, level);
    std::map<Place, std::uint32_t> found;
    for (const Cell& cell : h.cells_of(level)) {
      const CellId id(&cell - h.cells.data());
      const auto own = signatures.of(id);
      ASSERT_GE(own.size(), 1u);
      ASSERT_LE(own.size(), most);
      EXPECT_EQ(std::set(own.begin(), own.end()).size(), own.size());
      EXPECT_TRUE(std::ranges::equal(signatures.users(own[0]).cells, std::vector{id}));
      for (const std::uint32_t s : own) {
        EXPECT_GE(s, signatures.first(level));
        EXPECT_LT(s, signatures.first(level + 1));
        const auto [cells, parents] = signatures.users(s);
        EXPECT_TRUE(std::ranges::is_sorted(cells));
        EXPECT_TRUE(std::ranges::equal(parents, parents_of(h, cells)));
        EXPECT_TRUE(!exact || std::ranges::find(cells, id) != cells.end());
      }
      ASSERT_EQ(signatures.places(id).size(), cell.shared_ids.size());
      for (std::size_t k = 0; k < cell.shared_ids.size(); ++k) {
        const Place place = place_of(cell.positions[cell.first_shared() + k]);
        ASSERT_LT(signatures.places(id)[k], own.size());
        const std::uint32_t s = own[signatures.places(id)[k]];
        EXPECT_EQ(found.try_emplace(place, s).first->second, s);
        const auto cells = signatures.users(s).cells;
        const std::set<std::uint32_t>& twin = users.at(place);
        if (exact) {
          EXPECT_TRUE(std::ranges::equal(cells, twin));
        } else {
          EXPECT_TRUE(std::includes(cells.begin(), cells.end(), twin.begin(), twin.end()));
        }
      }
    }
  }
}

TEST(Signatures, AreTheCellsThatUseAPosition) {
  for (const IndexedMesh& mesh : {test::torus_mesh(64, 32), test::terrain_mesh(40), test::sphere_mesh(3)}) {
    const test::NaiveHierarchy small = test::naive_hierarchy(mesh, 4, 0.6f);
    expect_safe(small.hierarchy, find_signatures(small.hierarchy), Signatures::most, true);
  }
}

TEST(Signatures, AreUnitedWhereACellHasTooMany) {
  const test::NaiveHierarchy small = test::naive_hierarchy(test::torus_mesh(64, 32), 4, 0.6f);
  for (const std::size_t most : {2, 3, 5, 9}) {
    SCOPED_TRACE(most);
    expect_safe(small.hierarchy, find_signatures(small.hierarchy, most), most, false);
  }
}

// Levels of many cells are worked on in parts; what is united depends on the order of the sets.
TEST(Signatures, AreTheSameInWhateverOrderPartsAreFound) {
  const test::NaiveHierarchy small = test::naive_hierarchy(test::torus_mesh(64, 32), 4, 0.6f);
  const Hierarchy& h = small.hierarchy;
  ASSERT_GT(h.levels.back().cell_count, 3 * 64u) << "several parts";
  Runner backwards;
  backwards.run = [](std::size_t count, const Runner::Body& body) {
    while (count > 0) body(--count, 0);
  };
  for (const std::size_t most : {std::size_t{3}, Signatures::most}) {
    SignatureFinder finder(h, most, backwards);
    for (const Level& level : h.levels) {
      finder.begin_level();
      for (CellId c = level.first_cell; c < level.end_cell(); ++c) finder.add(c, h.cells[c]);
      finder.end_level();
    }
    EXPECT_EQ(std::move(finder).finish(), find_signatures(h, most).table()) << most;
  }
}

// Those of all vertices that a signature stands for, in all cells; that of the cell where nothing finer is known.
TEST(Signatures, HaveTheErrorsAroundTheirVertices) {
  test::NaiveHierarchy small = test::naive_hierarchy(test::torus_mesh(64, 32), 4, 0.6f);
  Hierarchy& h = small.hierarchy;
  std::mt19937 random(4);
  std::uniform_real_distribution<float> errors(0, 1);
  std::vector<std::vector<float>> of_cells(h.cells.size());
  for (std::size_t c = 0; c < h.levels.back().first_cell; c += 2) {  // every second cell
    for (std::size_t k = 0; k < h.cells[c].shared_ids.size(); ++k) of_cells[c].push_back(errors(random));
    h.cells[c].border_errors = of_cells[c];
  }
  for (const std::size_t most : {std::size_t{2}, Signatures::most}) {
    const Signatures signatures = find_signatures(h, most);
    std::vector<float> twin(signatures.first(h.finest() + 1), 0);
    for (CellId c{0}; c < h.cells.size(); ++c)
      for (std::size_t k = 0; k < h.cells[c].shared_ids.size(); ++k) {
        float& largest = twin[signatures.of(c)[signatures.places(c)[k]]];
        largest = std::max(largest, of_cells[c].empty() ? h.cells[c].error : of_cells[c][k]);
      }
    for (std::uint32_t s = 0; s < twin.size(); ++s) {
      EXPECT_EQ(signatures.error(s), signatures.users(s).cells.size() > 1 ? twin[s] : 0) << s;
    }
  }
}

TEST(Signatures, OfOneCell) {
  const test::NaiveHierarchy one = test::naive_hierarchy(test::sphere_mesh(1), 0, 0.6f);
  const Signatures signatures = find_signatures(one.hierarchy);
  EXPECT_EQ(signatures.of(CellId(0)).size(), 1u);
  EXPECT_TRUE(signatures.places(CellId(0)).empty());
  EXPECT_TRUE(signatures.users(0).parents.empty());
}

}  // namespace
}  // namespace lodestone
