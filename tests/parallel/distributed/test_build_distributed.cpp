// Builds by several ranks: the bytes of a build on one machine, whatever the input and the number of ranks.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "core/hierarchy/construct/cell_table.h"
#include "core/mesh/generate.h"
#include "parallel/distributed/cell_owners.h"
#include "parallel/distributed/generated_stream.h"
#include "parallel/distributed/shared_places.h"
#include "parallel/mesh/generate.h"
#include "tests/expect_error.h"
#include "tests/parallel/distributed/distributed.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;
using testing::Distributed;

RawMesh sphere(int times) { return test::raw_of(test::sphere_mesh(times)); }

TEST_F(Distributed, GivesTheBytesOfOneMachine) { expect_same(mesh(sphere(5))); }

TEST_F(Distributed, RepairsWhatOneMachineRepairs) {
  expect_same(mesh(test::with_faults(sphere(5), 1)));
  const auto scheduler = make_serial_scheduler();
  const RawMesh faulty = test::with_faults(sphere(4), 2);
  const DistributedResult result = build(open_mesh_stream(mesh(faulty)), 3, 0);
  ModelConfig config{.build = config_.build, .output = folder_ / "expected.lode"};
  const ModelResult expected = build_model(ModelSource{{folder_ / "m.ply"}}, config, *scheduler);
  EXPECT_EQ(result.tables.provenance.repairs, expected.hierarchy.provenance.repairs);
  EXPECT_GT(result.tables.provenance.repairs.welded_vertices, 0u);
  EXPECT_GT(result.tables.provenance.repairs.duplicate_triangles, 0u);
  EXPECT_GT(result.tables.provenance.repairs.non_finite_triangles, 0u);
  EXPECT_EQ(result.file_bytes, fs::file_size(config_.output));
}

TEST_F(Distributed, TakesTrianglesInAnyOrder) {
  RawMesh raw = sphere(5);
  std::mt19937 random(3);
  std::shuffle(raw.triangles.begin(), raw.triangles.end(), random);
  expect_same(mesh(raw));
}

TEST_F(Distributed, TakesFewTriangles) {
  expect_same(mesh(sphere(0)));  // some ranks have no triangle at all
  config_.build.finest_level = 4;
  expect_same(mesh(sphere(1)));
}

TEST_F(Distributed, ExchangesByWayOfOtherRanks) {
  most_direct_ = 0;
  const std::string expected = in_memory({mesh(test::with_faults(sphere(5), 3))});
  for (const int ranks : {2, 5, 7, 9}) EXPECT_TRUE(built({folder_ / "m.ply"}, ranks, 0) == expected) << ranks;
}

// Every rank is told the same work in the same order, its share grows, and what is done in rounds ends for all at once.
TEST_F(Distributed, TellsHowFarAllRanksAre) {
  struct Told {
    std::vector<std::string> works;
    std::map<std::string, std::vector<double>> shares;
  };
  std::vector<Told> told(3);
  on_progress_ = [&](int rank, const std::string& work, double share) {
    Told& own = told[static_cast<std::size_t>(rank)];
    if (share == 0)
      own.works.push_back(work);
    else
      own.shares[work].push_back(share);
  };
  (void)built({mesh(sphere(6))}, 3, 2);
  for (const Told& own : told) {
    EXPECT_EQ(own.works, told.front().works);
    for (const auto& [work, shares] : own.shares) {
      EXPECT_TRUE(std::ranges::is_sorted(shares)) << work;
      EXPECT_GT(shares.front(), 0) << work;
      EXPECT_LE(shares.back(), 1) << work;
    }
    for (const char* in_rounds : {"reading corners", "welding", "comparing triangles", "choosing cells", "sorting",
                                  "fetching vertices", "finding shared vertices"})
      EXPECT_EQ(own.shares.at(in_rounds), told.front().shares.at(in_rounds)) << in_rounds;
    for (const char* whole : {"welding", "sorting", "writing"}) EXPECT_EQ(own.shares.at(whole).back(), 1) << whole;
  }
  EXPECT_TRUE(std::ranges::any_of(told, [](const Told& t) { return t.shares.contains("building level 2"); }));
}

TEST_F(Distributed, BuildsHalfLevels) {
  config_.build.half_levels = true;
  expect_same(mesh(sphere(5)));
  config_.build.finest_level = 3;  // the coarser level of its grid
  expect_same(mesh(sphere(4)));
}

TEST_F(Distributed, PutsVerticesOnALattice) {
  config_.lattice = {12};
  expect_same(mesh(sphere(4)));
}

TEST_F(Distributed, BuildsGeneratedSurfacesWithoutAFile) {
  const auto scheduler = make_tbb_scheduler(2);
  for (const char* text : {"terrain:30000:3", "torus:20000", "pile:3000:2"}) {
    const GenerateConfig config = parse_generator(text);
    (void)generate_ply(config, folder_ / "g.ply", *scheduler);
    const std::string expected = in_memory({folder_ / "g.ply"});
    (void)build(generated_stream(config), 3, 2);
    EXPECT_TRUE(content(config_.output) == expected) << text;
  }
}

TEST_F(Distributed, TellsWhatEachRankHasDone) {
  const DistributedResult result = build(open_mesh_stream(mesh(sphere(5))), 3, 0);
  ASSERT_EQ(result.ranks.size(), 3u);
  std::uint64_t triangles = 0, cells = 0;
  for (const RankReport& rank : result.ranks) {
    triangles += rank.triangles;
    cells += rank.cells;
    EXPECT_GT(rank.total().traffic.bytes_sent, 0u);
    EXPECT_GT(rank.total().traffic.bytes_received, 0u);
    EXPECT_GE(rank.total().traffic.rounds, result.ranks.back().total().traffic.rounds);
  }
  EXPECT_EQ(triangles, 8u << 10);
  EXPECT_EQ(cells, result.tables.cells.size());
}

// Nothing is sent to be compared that cannot equal anything of another rank.
TEST_F(Distributed, SendsLittleOfAnOrderedInput) {
  const auto bytes = [&](const RawMesh& raw) {
    const DistributedResult result = build(open_mesh_stream(mesh(raw)), 3, 0);
    std::uint64_t sum = 0;
    for (const RankReport& rank : result.ranks) sum += rank.stages.front().traffic.bytes_sent;
    return static_cast<double>(sum) / static_cast<double>(raw.triangles.size());
  };
  RawMesh raw = test::raw_of(test::terrain_mesh(150));
  EXPECT_LT(bytes(raw), 2.5);
  std::mt19937 random(3);
  std::shuffle(raw.triangles.begin(), raw.triangles.end(), random);
  EXPECT_GT(bytes(raw), 10);
}

TEST(SharedPlaces, AreWhereSeveralRanksHaveVertices) {
  constexpr std::size_t count = 3000;
  run_local_ranks(3, [&](Transport& transport) {
    Ranks ranks(transport);
    std::mt19937 random(7);  // of all ranks alike: what each draws for itself is in layers of their own
    std::uniform_real_distribution<float> anywhere(0, 1);
    std::vector<Vec3f> positions;
    std::vector<VertexState> states;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3f p{anywhere(random), anywhere(random), anywhere(random)};
      const bool common = i % 10 == 0;
      const float layer = (static_cast<float>(ranks.rank()) + 0.1f + 0.8f * p.z) / 3;
      positions.push_back({p.x, p.y, common ? p.z : layer});
      states.push_back(i % 10 == 1 ? VertexState::unused : VertexState::used);
    }
    const SharedPlaces shared(positions, states, 3 * count, ranks);
    std::size_t alone = 0;
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_TRUE(i % 10 != 0 || shared.contains(positions[i]));
      alone += !shared.contains(positions[i]);
    }
    EXPECT_GT(alone, count / 5);
  });
}

TEST_F(Distributed, RefusesWhatItDoesNotBuild) {
  const fs::path path = mesh(sphere(2));
  const std::shared_ptr<const MeshStream> stream = open_mesh_stream(path);
  config_.build.refine = true;
  expect_error_of<UnsupportedError>([&] { (void)build(stream, 2, 0); }, {"splitting long edges"});
  config_.build.refine = false;
  config_.build.order_cells = true;
  expect_error_of<UnsupportedError>([&] { (void)build(stream, 2, 0); }, {"compressed"});
  config_.build.order_cells = false;
  const fs::path coloured = test_folder_.write(
      "c.ply",
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n" +
          std::string(3 * 15, '\3') + std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13));
  expect_error_of<UnsupportedError>([&] { (void)build(open_mesh_stream(coloured), 2, 0); },
                                    {"c.ply", "attributes", "open_rank_input"});
}

// Cells of 8 x 8 x 4 on level 3, all of them.
TEST(CellOwners, KeepBlocksTogetherAndShareThemOut) {
  std::vector<CellCode> cells;
  for (std::uint16_t x = 0; x < 8; ++x)
    for (std::uint16_t y = 0; y < 8; ++y)
      for (std::uint16_t z = 0; z < 4; ++z) cells.push_back(CellCode::from({x, y, z}));
  const CellOwners owners(3, cells, 4);
  std::map<std::uint64_t, int> of_block;
  std::vector<int> shares(4);
  for (const CellCode cell : cells) {
    const int owner = owners.owner(cell, 3);
    ++shares.at(static_cast<std::size_t>(owner));
    const std::uint64_t block = CellCode::from(block_of_parent(cell.parent().coord())).morton;
    EXPECT_EQ(of_block.try_emplace(block, owner).first->second, owner);
  }
  EXPECT_LT(std::ranges::max(shares), 2 * 64);
  EXPECT_GT(std::ranges::min(shares), 0);
  for (const CellCode cell : cells) {  // the cells of level 1 have one block, as the root has
    EXPECT_EQ(owners.owner(cell.parent().parent(), 1), owners.owner(CellCode{0}, 1));
    EXPECT_EQ(owners.owner(CellCode{0}, 0), owners.owner(CellCode{0}, 1));
  }
  EXPECT_EQ(CellOwners(0, {}, 3).owner(CellCode{0}, 0), 2);  // no sample
}

TEST(ParseGenerator, ReadsShapeCountAndSeed) {
  const GenerateConfig config = parse_generator("terrain:4e6:7");
  EXPECT_EQ(config.shape, Shape::terrain);
  EXPECT_EQ(config.triangles, 4'000'000u);
  EXPECT_EQ(config.seed, 7u);
  EXPECT_EQ(parse_generator("sphere:1000").seed, GenerateConfig{}.seed);
  for (const char* text : {"", "sphere", "sphere:", "sphere:x", "sphere:10:", "sphere:10:1:2", "sphere:1.5"})
    expect_error_of<InputError>([&] { (void)parse_generator(text); }, {"SHAPE:TRIANGLES:SEED"});
  expect_error_of<InputError>([&] { (void)parse_generator("cone:100"); }, {"cone"});
}

}  // namespace
}  // namespace lodestone
