// Plans for many ranks, beside the reports of builds by as many, and a simpler count.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "parallel/distributed/cell_message.h"
#include "parallel/distributed/cell_owners.h"
#include "parallel/distributed/plan_ranks.h"
#include "parallel/distributed/rank_save.h"
#include "parallel/hierarchy/save.h"
#include "tests/parallel/distributed/distributed.h"

namespace lodestone {
namespace {

using testing::Distributed;

RawMesh sphere(int times) { return test::raw_of(test::sphere_mesh(times)); }

class PlanRanks : public Distributed {
 protected:
  [[nodiscard]] Hierarchy file() const { return load_lode(config_.output, *make_serial_scheduler()); }
};

std::uint64_t bytes_of_levels(const DistributedResult& result) {
  std::uint64_t sum = 0;
  for (const RankReport& rank : result.ranks) sum += rank.stages[3].traffic.bytes_sent;
  return sum;
}

double imbalance(const DistributedResult& result) {
  double most = 0, sum = 0;
  for (const RankReport& rank : result.ranks) {
    most = std::max(most, static_cast<double>(rank.triangles));
    sum += static_cast<double>(rank.triangles);
  }
  return most * static_cast<double>(result.ranks.size()) / sum;
}

// Every message has 32 bytes before its content, and what ranks add up has 16 for each.
std::uint64_t most_envelopes(const DistributedResult& result) {
  const std::uint64_t ranks = result.ranks.size();
  return result.ranks.front().stages[3].traffic.rounds * ranks * (ranks - 1) * (32 + 16);
}

TEST_F(PlanRanks, SayWhatBuildsReport) {
  const std::shared_ptr<const MeshStream> stream = open_mesh_stream(mesh(sphere(6)));
  for (const int ranks : {1, 2, 3, 5, 8}) {
    config_.build.half_levels = ranks == 3;
    const DistributedResult built = build(stream, ranks, 0);
    const RankPlan plan = plan_ranks(file(), {.ranks = ranks});
    EXPECT_EQ(plan.samples, 32768u);  // all of them: the same borders
    EXPECT_DOUBLE_EQ(plan.imbalance, imbalance(built)) << ranks;
    EXPECT_LE(plan.moved_bytes(), bytes_of_levels(built)) << ranks;
    EXPECT_GE(plan.moved_bytes() + most_envelopes(built), bytes_of_levels(built)) << ranks;
    EXPECT_EQ(plan.moved_bytes() > 0, ranks > 1);
    ASSERT_EQ(plan.levels.size(), built.tables.levels.size());
    for (std::size_t l = 0; l < plan.levels.size(); ++l)
      EXPECT_EQ(plan.levels[l].cells, built.tables.levels[l].cell_count);
  }
}

// The sample of an input in the order of space is as even as that of the plan; one without order is drawn at random.
TEST_F(PlanRanks, KeepToBuildsByASampleOfTheTriangles) {
  RawMesh raw = sphere(8);
  const std::shared_ptr<const MeshStream> stream = open_mesh_stream(mesh(raw));
  const DistributedResult built = build(stream, 6, 0);
  const Hierarchy hierarchy = file();
  const RankPlan even = plan_ranks(hierarchy, {.ranks = 6}), drawn = plan_ranks(hierarchy, {.ranks = 6, .seed = 1});
  EXPECT_EQ(even.samples, 65536u);
  EXPECT_EQ(drawn.samples, even.samples);
  for (const RankPlan& plan : {even, drawn}) {
    EXPECT_NEAR(plan.imbalance, imbalance(built), 0.03);
    EXPECT_NEAR(static_cast<double>(plan.moved_bytes()), static_cast<double>(bytes_of_levels(built)),
                0.1 * static_cast<double>(bytes_of_levels(built)));
  }
}

TEST_F(PlanRanks, CountTheVerticesBetweenRanks) {
  (void)build(open_mesh_stream(mesh(sphere(6))), 2, 0);
  const Hierarchy hierarchy = file();
  std::vector<CellCode> sample;
  for (const Cell& cell : hierarchy.cells_of(hierarchy.finest()))
    sample.insert(sample.end(), cell.triangles.size(), cell.code);
  for (const int ranks : {1, 3, 7}) {
    const CellOwners owners(hierarchy.finest(), sample, ranks);
    std::map<std::array<float, 3>, std::set<int>> users;
    for (const Cell& cell : hierarchy.cells_of(hierarchy.finest()))
      for (const Vec3f& p : cell.positions) users[{p.x, p.y, p.z}].insert(owners.owner(cell.code, hierarchy.finest()));
    std::uint64_t expected = 0;
    std::vector<std::uint64_t> of_rank(static_cast<std::size_t>(ranks));
    for (const auto& [position, by] : users)
      if (by.size() > 1) {
        expected += by.size();
        for (const int rank : by) ++of_rank[static_cast<std::size_t>(rank)];
      }
    const RankPlan plan = plan_ranks(hierarchy, {.ranks = ranks});
    EXPECT_EQ(plan.border_vertices, expected) << ranks;
    EXPECT_EQ(plan.most_border_vertices, std::ranges::max(of_rank)) << ranks;
  }
}

TEST_F(PlanRanks, FollowEveryLevel) {
  (void)build(open_mesh_stream(mesh(sphere(6))), 2, 0);
  const Hierarchy hierarchy = file();
  for (const int ranks : {1, 16, 4096}) {
    const RankPlan plan = plan_ranks(hierarchy, {.ranks = ranks});
    EXPECT_EQ(plan.levels.front().busy_ranks, 1);  // the root lies on one
    EXPECT_EQ(plan.levels.back().moved_cells, 0u);
    for (const LevelPlan& level : plan.levels) {
      EXPECT_LE(level.busy_ranks, ranks);
      EXPECT_LE(static_cast<std::uint64_t>(level.busy_ranks), level.blocks);
      EXPECT_LE(level.most_triangles, level.triangles);
      EXPECT_GE(level.most_triangles * static_cast<std::uint64_t>(level.busy_ranks), level.triangles);
      EXPECT_LE(level.moved_cells, level.cells);
      EXPECT_LE(level.largest_message, std::min(level.most_sent, level.most_received));
      EXPECT_LE(level.most_sent, level.moved_bytes);
    }
    EXPECT_GE(plan.first_rank_bytes, table_bytes_per_cell * hierarchy.cells.size());
  }
}

TEST_F(PlanRanks, TakeOneCell) {
  config_.build.finest_level = 0;
  (void)build(open_mesh_stream(mesh(sphere(0))), 2, 0);
  const RankPlan plan = plan_ranks(file(), {.ranks = 3});
  EXPECT_EQ(plan.levels.front().blocks, 1u);
  EXPECT_DOUBLE_EQ(plan.imbalance, 3);
  EXPECT_EQ(plan.moved_bytes(), 0u);
  EXPECT_EQ(plan.border_vertices, 0u);
}

TEST(CellMessage, HasTheBytesThatAreStated) {
  for (const AttributeSet& attributes : {AttributeSet{}, AttributeSet{.wedges = true, .uv = true, .materials = true},
                                         AttributeSet{.wedges = true, .colours = true}}) {
    CellBuild cell;
    cell.slab.allocate(7, 3, 5, attributes);
    cell.triangles = cell.slab.triangles;
    cell.ids.resize(7), cell.vertex_errors.resize(7), cell.usage.resize(3), cell.border_errors.resize(3);
    if (attributes.wedges) cell.vertex_ids.resize(7);
    Message message;
    append_cell(CellCode{1}, cell, message);
    EXPECT_EQ(message.size(), cell_message_bytes({7, 3, 5, attributes}));
    CellBuild read;
    CellReader reader(message, attributes);
    EXPECT_EQ(reader.read(read), CellCode{1});
    EXPECT_TRUE(reader.at_end());
    EXPECT_EQ(read.vertex_ids, cell.vertex_ids);
    EXPECT_EQ(read.slab.uv.size(), cell.slab.uv.size());
  }
}

}  // namespace
}  // namespace lodestone
