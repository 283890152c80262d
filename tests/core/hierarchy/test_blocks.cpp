// Blocks and their kernel against brute force: which cells belong together, which vertices must be locked, what the
// parents hold. The simplifier here is a hostile one: random collapses without regard for shape or topology.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "core/base/key_numbers.h"
#include "core/hierarchy/construct/block.h"
#include "core/hierarchy/construct/finest_cell.h"
#include "core/simplify/simplifiers.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

// Collapses unlocked vertices onto random neighbours, in chains; the survivors move a little.
class RandomSimplifier final : public Simplifier {
 public:
  const SimplifyResult& simplify(const SimplifyInput& input) override {
    locked.assign(input.locked.begin(), input.locked.end());
    const std::size_t n = input.positions.size();
    std::vector<std::uint32_t> neighbour(n);
    for (std::uint32_t v = 0; v < n; ++v) neighbour[v] = v;
    for (const Triangle& t : input.triangles)
      for (int k = 0; k < 3; ++k)
        if (random_() % 3 == 0) neighbour[t.v[k]] = t.v[(k + 1) % 3];
    result_.parent.assign(n, 0);
    result_.positions.assign(input.positions.begin(), input.positions.end());
    for (std::uint32_t v = 0; v < n; ++v) {
      const bool goes = !input.locked[v] && neighbour[v] > v && random_() % 4 != 0;  // > v: no cycles
      result_.parent[v] = goes ? neighbour[v] : v;
    }
    for (std::uint32_t v = static_cast<std::uint32_t>(n); v-- > 0;)
      result_.parent[v] = result_.parent[result_.parent[v]];
    for (std::uint32_t v = 0; v < n; ++v)
      if (result_.parent[v] == v && !input.locked[v]) result_.positions[v].x += 1e-5f;
    return result_;
  }
  std::vector<std::uint8_t> locked;

 private:
  std::mt19937 random_{7};
  SimplifyResult result_;
};

// `quadric`, but with what it says about distances withheld, or blown up to the displacement for a few vertices.
class MisjudgingSimplifier final : public Simplifier {
 public:
  explicit MisjudgingSimplifier(bool withhold) : withhold_(withhold) {}
  const SimplifyResult& simplify(const SimplifyInput& input) override {
    result_ = inner_->simplify(input);
    for (std::size_t v = 0; v < result_.distance.size(); v += 97)
      result_.distance[v] = length(result_.positions[result_.parent[v]] - input.positions[v]);
    if (withhold_) result_.distance.clear();
    return result_;
  }

 private:
  bool withhold_;
  std::unique_ptr<Simplifier> inner_ = make_simplifier("quadric");
  SimplifyResult result_;
};

struct SmallBuild {
  BlockPlan plan;
  std::vector<std::vector<CellBuild>> cells;
  std::vector<Triangle> triangles;
  std::vector<std::vector<std::set<std::uint32_t>>> used_ids;  // by level and rank, before transient data goes
};

// The finest level by maps and sets.
SmallBuild start(const IndexedMesh& mesh, int finest, LevelGrids grids = {}) {
  const int grid = grids.of(finest);
  SmallBuild build;
  std::map<CellCode, std::vector<Triangle>> by_cell;
  std::map<std::uint32_t, std::set<CellCode>> cells_of;
  for (const Triangle& t : mesh.triangles) {
    const CellCode code = CellCode::from(
        cell_of(barycentre(mesh.positions[t.v[0]], mesh.positions[t.v[1]], mesh.positions[t.v[2]]), grid));
    by_cell[code].push_back(t);
    for (const std::uint32_t v : t.v) cells_of[v].insert(code);
  }
  std::vector<CellCode> codes;
  for (const auto& [code, list] : by_cell) {
    codes.push_back(code);
    build.triangles.insert(build.triangles.end(), list.begin(), list.end());
  }
  build.plan = plan_blocks(codes, finest, grids);
  for (const LevelCells& level : build.plan.levels) build.cells.emplace_back(level.codes.size());

  FinestVertices vertices{mesh.positions, std::vector<std::uint32_t>(mesh.positions.size(), 0), 0};
  for (const auto& [v, cells] : cells_of)
    if (cells.size() > 1) vertices.sharing[v] = FinestVertices::shared_flag;
  FinestCellScratch scratch;
  KeyNumbers<std::uint32_t> numbers;
  std::size_t first = 0;
  for (std::size_t c = 0; c < codes.size(); ++c) {
    CellBuild& cell = build.cells.back()[c];
    cell.triangles = std::span(build.triangles).subspan(first, by_cell[codes[c]].size());
    numbers.clear();
    for (Triangle& t : cell.triangles) numbers.number(t.v, t.v.data());
    cell.ids.assign(numbers.keys().begin(), numbers.keys().end());
    (void)make_finest_cell(vertices, codes[c], grid, 1, cell, scratch);
    for (const std::uint32_t v : cell.slab.shared_ids) {
      UsageBox box;
      for (const CellCode user : cells_of.at(v)) box.extend(user.coord());
      cell.usage.push_back(box);
    }
    std::fill(cell.slab.normals.begin() + static_cast<std::ptrdiff_t>(cell.first_shared()), cell.slab.normals.end(),
              pack_normal({0, 0, 1}));
    first += cell.triangles.size();
  }
  return build;
}

// Every vertex of a level by the ids of its cells, as the builder's transient data says.
std::map<std::uint32_t, std::set<CellRank>> users(const std::vector<CellBuild>& cells) {
  std::map<std::uint32_t, std::set<CellRank>> result;
  for (CellRank c{0}; c < cells.size(); ++c)
    for (const std::uint32_t id : cells[c].ids) result[id].insert(c);
  return result;
}

class Blocks : public testing::TestWithParam<IndexedMesh (*)()> {};

void expect_exact_locks(SmallBuild build) {
  RandomSimplifier simplifier;
  BlockScratch scratch;
  for (std::size_t level = build.plan.levels.size() - 1; level > 0; --level) {
    const auto used_by = users(build.cells[level]);
    const LevelCells& parents = build.plan.levels[level - 1];
    for (std::uint32_t b = 0; b < build.plan.block_count[level]; ++b) {
      const Block& block = build.plan.blocks[build.plan.first_block[level] + b];
      std::set<CellRank> inside;
      for (const CellRank p : block.parents)
        for (CellRank c = parents.first_child[p]; c < parents.first_child[p + 1]; ++c) inside.insert(c);
      build_block({block, parents, build.cells[level], build.cells[level - 1], 1, build.plan.grids}, simplifier,
                  scratch);
      for (std::size_t v = 0; v < scratch.ids.size(); ++v) {
        bool used_outside = false;
        for (const CellRank c : used_by.at(scratch.ids[v])) used_outside |= !inside.contains(c);
        ASSERT_EQ(simplifier.locked[v] != 0, used_outside) << "level " << level << " id " << scratch.ids[v];
      }
    }
    // Shared ids of the coarser level name exactly the vertices of several cells.
    const auto coarse_users = users(build.cells[level - 1]);
    for (const CellBuild& cell : build.cells[level - 1])
      for (std::size_t i = 0; i < cell.vertex_count(); ++i) {
        const bool shared = i >= cell.first_shared();
        ASSERT_EQ(shared, coarse_users.at(cell.ids[i]).size() > 1) << "level " << level - 1 << " id " << cell.ids[i];
        if (shared) {
          ASSERT_EQ(cell.slab.shared_ids[i - cell.first_shared()], cell.ids[i]);
        }
      }
  }
}

TEST_P(Blocks, LocksExactlyTheVerticesUsedOutside) { expect_exact_locks(start(GetParam()(), 5)); }

TEST_P(Blocks, OfHalfLevelsDoSoToo) {
  for (const int finest : {8, 9}) expect_exact_locks(start(GetParam()(), finest, {true}));
}

INSTANTIATE_TEST_SUITE_P(Meshes, Blocks,
                         testing::Values([] { return test::sphere_mesh(5); }, [] { return test::terrain_mesh(70); },
                                         [] { return test::torus_mesh(90, 40); }));

float error_at_the_root(const IndexedMesh& mesh, Simplifier& simplifier) {
  SmallBuild build = start(mesh, 3);
  BlockScratch scratch;
  for (const Block& block : build.plan.blocks) {
    const auto level = static_cast<std::size_t>(block.level);
    build_block({block, build.plan.levels[level - 1], build.cells[level], build.cells[level - 1], 1}, simplifier,
                scratch);
  }
  return build.cells[0].front().error;
}

TEST(BlockErrors, AreMeasuredAgainWhereASimplifierOverstates) {
  const IndexedMesh mesh = test::terrain_mesh(90, 0.02);
  const auto quadric = make_simplifier("quadric");
  MisjudgingSimplifier silent(true), overstating(false);
  const float searched = error_at_the_root(mesh, silent);
  EXPECT_NEAR(error_at_the_root(mesh, *quadric), searched, 0.05f * searched);
  EXPECT_NEAR(error_at_the_root(mesh, overstating), searched, 0.05f * searched);
}

TEST(BlockPlan, GroupsSiblingsAndShiftsFromLevelToLevel) {
  std::vector<CellCode> codes;
  for (std::uint16_t z = 0; z < 16; ++z)
    for (std::uint16_t y = 0; y < 16; ++y)
      for (std::uint16_t x = 0; x < 16; ++x)
        if ((x * 7 + y * 3 + z) % 3) codes.push_back(CellCode::from({x, y, z}));
  std::sort(codes.begin(), codes.end());
  const BlockPlan plan = plan_blocks(codes, 4);
  ASSERT_EQ(plan.levels.size(), 5u);
  EXPECT_EQ(plan.levels[0].codes.size(), 1u);
  for (std::size_t l = 1; l < 5; ++l) {
    std::set<CellRank> made;
    for (std::uint32_t b = plan.first_block[l]; b < plan.first_block[l] + plan.block_count[l]; ++b) {
      const Block& block = plan.blocks[b];
      for (const CellRank p : block.parents) {
        EXPECT_TRUE(made.insert(p).second);
        for (CellRank c = plan.levels[l - 1].first_child[p]; c < plan.levels[l - 1].first_child[p + 1]; ++c) {
          EXPECT_EQ(plan.levels[l].codes[c].parent(), plan.levels[l - 1].codes[p]);
          UsageBox box;
          box.extend(plan.levels[l].codes[c].coord());
          EXPECT_TRUE(box.inside(block.range));
        }
      }
      // [4k-2, 4k+2): a border at 2 modulo 4, whose parent plane is odd, so never a border of the next level (even).
      EXPECT_TRUE(block.range.lo.x == 0 || block.range.lo.x % 4 == 2);
      EXPECT_EQ(block.range.hi.x % 4, 1);
    }
    EXPECT_EQ(made.size(), plan.levels[l - 1].codes.size());
  }
}

// Planes at 0 modulo 4 where parents are the same cells, at 2 modulo 4 where they are not: none of a block is one of
// the next coarser level.
TEST(BlockPlan, HalfLevelsKeepTheCellsEveryOtherTime) {
  std::vector<CellCode> codes;
  for (std::uint64_t morton = 0; morton < 512; ++morton) codes.push_back({morton});
  const BlockPlan plan = plan_blocks(codes, 6, {true});
  ASSERT_EQ(plan.levels.size(), 7u);
  for (std::size_t l = 1; l < 7; ++l) {
    const bool same = l % 2 == 0;
    EXPECT_EQ(plan.levels[l].codes.size(), std::size_t{1} << 3 * ((l + 1) / 2));
    EXPECT_EQ(plan.levels[l].codes == plan.levels[l - 1].codes, same);
    for (std::uint32_t b = plan.first_block[l]; b < plan.first_block[l] + plan.block_count[l]; ++b) {
      const Block& block = plan.blocks[b];
      EXPECT_LE(block.parents.size(), most_parents);
      EXPECT_TRUE(block.range.lo.x == 0 || block.range.lo.x % 4 == (same ? 0 : 2));
      for (const CellRank p : block.parents)
        for (CellRank c = plan.levels[l - 1].first_child[p]; c < plan.levels[l - 1].first_child[p + 1]; ++c) {
          UsageBox box;
          box.extend(plan.levels[l].codes[c].coord());
          EXPECT_TRUE(box.inside(block.range));
        }
    }
  }
}

TEST(BlockPlan, DependenciesAreTheMakersOfTheCells) {
  std::vector<CellCode> codes;
  std::mt19937 random(3);
  std::set<CellCode> chosen;
  for (int i = 0; i < 300; ++i)
    chosen.insert(
        CellCode::from({std::uint16_t(random() % 32), std::uint16_t(random() % 32), std::uint16_t(random() % 32)}));
  codes.assign(chosen.begin(), chosen.end());
  const BlockPlan plan = plan_blocks(codes, 5);
  std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
  for (std::uint32_t maker = 0; maker < plan.blocks.size(); ++maker)
    for (std::uint32_t consumer = 0; consumer < plan.blocks.size(); ++consumer) {
      if (plan.blocks[consumer].level + 1 != plan.blocks[maker].level) continue;
      const LevelCells& coarse = plan.levels[static_cast<std::size_t>(plan.blocks[consumer].level) - 1];
      for (const CellRank made : plan.blocks[maker].parents)
        for (const CellRank p : plan.blocks[consumer].parents)
          if (made >= coarse.first_child[p] && made < coarse.first_child[p + 1]) expected.emplace(maker, consumer);
    }
  EXPECT_EQ(std::set(plan.dependencies.begin(), plan.dependencies.end()), expected);
  EXPECT_EQ(plan.dependencies.size(), expected.size());
}

TEST(CellCode, MortonRoundTripAndParent) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const CellCoord c{std::uint16_t(random()), std::uint16_t(random()), std::uint16_t(random())};
    EXPECT_EQ(CellCode::from(c).coord(), c);
    const CellCoord half{std::uint16_t(c.x / 2), std::uint16_t(c.y / 2), std::uint16_t(c.z / 2)};
    EXPECT_EQ(CellCode::from(c).parent().coord(), half);
  }
}

TEST(CellCode, FarFacesBelongToTheLastCells) {
  EXPECT_EQ(cell_of({1, 1, 1}, 3), (CellCoord{7, 7, 7}));
  EXPECT_EQ(cell_of({0.125f, 0.25f, std::nextafter(0.25f, 0.0f)}, 3), (CellCoord{1, 2, 1}));
  EXPECT_EQ(cell_of({0, 0, 0}, 15), (CellCoord{0, 0, 0}));
}

}  // namespace
}  // namespace lodestone
