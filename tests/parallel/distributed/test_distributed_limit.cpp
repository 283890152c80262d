// Builds by ranks that keep their cells in temporary files: the same bytes, limits that cannot be kept, and what is
// left behind.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <random>
#include <set>

#include "core/base/byte_size.h"
#include "parallel/distributed/building/received_triangles.h"
#include "parallel/distributed/generated_stream.h"
#include "tests/expect_error.h"
#include "tests/parallel/distributed/distributed.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;
using testing::Distributed;

RawMesh sphere(int times) { return test::raw_of(test::sphere_mesh(times)); }

class DistributedLimit : public Distributed {
 protected:
  DistributedLimit() { config_.limit = {.scratch = folder_, .part = 700}; }
};

TEST_F(DistributedLimit, GivesTheBytesOfOneMachine) { expect_same(mesh(sphere(5))); }

TEST_F(DistributedLimit, RepairsWhatOneMachineRepairs) {
  expect_same(mesh(test::with_faults(sphere(5), 1)));
  const DistributedResult stored = build(open_mesh_stream(folder_ / "m.ply"), 3, 0);
  EXPECT_TRUE(stored.spilled);
  config_.limit = {};
  const DistributedResult in_memory = build(open_mesh_stream(folder_ / "m.ply"), 3, 0);
  EXPECT_FALSE(in_memory.spilled);
  EXPECT_EQ(stored.tables.provenance.repairs, in_memory.tables.provenance.repairs);
  EXPECT_GT(stored.tables.provenance.repairs.welded_vertices, 0u);
  EXPECT_GT(stored.tables.provenance.repairs.duplicate_triangles, 0u);
  for (std::size_t r = 0; r < 3; ++r) {
    EXPECT_EQ(stored.ranks[r].triangles, in_memory.ranks[r].triangles);
    EXPECT_EQ(stored.ranks[r].cells, in_memory.ranks[r].cells);
  }
}

TEST_F(DistributedLimit, TakesTrianglesInAnyOrder) {
  RawMesh raw = sphere(5);
  std::mt19937 random(3);
  std::shuffle(raw.triangles.begin(), raw.triangles.end(), random);
  expect_same(mesh(raw));
}

TEST_F(DistributedLimit, TakesFewTriangles) {
  expect_same(mesh(sphere(0)));  // some ranks have no triangle at all
  config_.build.finest_level = 0;
  expect_same(mesh(sphere(2)));
}

TEST_F(DistributedLimit, BuildsHalfLevelsOnALattice) {
  config_.build.half_levels = true;
  config_.lattice = {12};
  expect_same(mesh(sphere(5)));
}

TEST_F(DistributedLimit, LeavesNoTemporaryFile) {
  (void)build(open_mesh_stream(mesh(sphere(4))), 3, 2);
  EXPECT_EQ(files(), 2u);  // the input and the output
}

TEST_F(DistributedLimit, LeavesNoFileWhereARankFails) {
  const std::shared_ptr<const MeshStream> stream = open_mesh_stream(mesh(sphere(4)));
  std::atomic<int> sent{0};
  const auto build_until = [&](int at) {
    sent = 0;
    const LocalRanksConfig local{.timeout_seconds = 5, .on_send = [&](int from, int, Message&) {
                                   if (from == 1 && sent++ == at) throw FileError("disk: cannot write: I/O error");
                                   return true;
                                 }};
    (void)build(stream, 3, 0, local);
  };
  build_until(-1);
  fs::remove(config_.output);
  const int messages = sent;
  for (int at = 0; at < messages; at += 1 + messages / 12) {
    expect_error_of<FileError>([&] { build_until(at); }, {"rank 1 on this process", "disk: cannot write"});
    EXPECT_EQ(files(), 1u);
  }
}

TEST_F(DistributedLimit, RefusesAFolderThatIsMissing) {
  config_.limit.scratch = folder_ / "missing";
  expect_error_of<FileError>([&] { (void)build(open_mesh_stream(mesh(sphere(2))), 2, 0); }, {"missing"});
}

TEST_F(DistributedLimit, NamesTheLeastLimit) {
  config_.limit = {.bytes = 8 * mebibyte};
  const std::shared_ptr<const MeshStream> stream = open_mesh_stream(mesh(sphere(3)));
  std::uint64_t least = 0;
  try {
    (void)build(stream, 2, 0);
    FAIL() << "a limit of 8 MiB was kept";
  } catch (const ResourceError& error) {
    EXPECT_NE(std::string(error.what()).find("m.ply: building by ranks needs "), std::string::npos) << error.what();
    least = testing::least_in(error.what());
  }
  config_.limit.bytes = least - mebibyte;
  EXPECT_THROW((void)build(stream, 2, 0), ResourceError);
  config_.limit.bytes = least;
  EXPECT_EQ(build(stream, 2, 0).ranks.size(), 2u);
}

// The memory of ranks for a generated surface, of which nothing is read.
class LimitOfRanks : public FolderTest {
 protected:
  template <class Body>
  void with_memory(const char* surface, int count, const RankLimit& limit, const Body& body) const {
    run_local_ranks(count, [&](Transport& transport) {
      Ranks ranks(transport);
      const RankInput input = shared_out(generated_stream(parse_generator(surface)), count);
      body(RankMemory(input, limit, {}, ranks, 1));
    });
  }
  std::uint64_t least(const char* surface, int count) const {
    try {
      with_memory(surface, count, {.bytes = 1, .scratch = folder_}, [](const RankMemory&) {});
    } catch (const ResourceError& error) {
      return testing::least_in(error.what());
    }
    return 0;
  }
};

TEST_F(LimitOfRanks, IsAsDocumented) {
  EXPECT_LE(least("sphere:1e9", 8), 2048 * mebibyte);
  EXPECT_GT(least("sphere:1e9", 8), 1024 * mebibyte);
  EXPECT_LE(least("sphere:1e8", 8), 48 * 12'500'000 + 64 * mebibyte);
}

TEST_F(LimitOfRanks, RefusesAFullDisk) {
  expect_error_of<FileError>(
      [&] { with_memory("sphere:1e6", 2, {.scratch = "/proc", .part = 1}, [](const RankMemory&) {}); },
      {"temporary files of 2 ranks need about", "--scratch"});
}

TEST_F(LimitOfRanks, RefusesBlocksWithoutRoom) {
  with_memory(
      "sphere:1e5", 1, {.bytes = 200 * mebibyte, .scratch = folder_, .part = 1000}, [](const RankMemory& memory) {
        EXPECT_EQ(memory.lanes({.vertices = 1000, .largest_block = 1000}), 1u);
        expect_error_of<ResourceError>([&] { (void)memory.lanes({.vertices = 1000, .largest_block = 1'000'000}); },
                                       {"the cells and blocks of a rank need", "--memory-limit", "more ranks"});
      });
}

// Each turn reads all borders again.
TEST_F(LimitOfRanks, ComparesBordersInFewTurns) {
  constexpr std::uint64_t cells = 200'000, copies = 17'000'000;  // of a rank
  with_memory("sphere:1e9", 8, {.bytes = 2048 * mebibyte, .scratch = folder_, .resume = true},
              [](const RankMemory& memory) { EXPECT_GE(memory.compared_copies(cells, copies), copies / 8); });
  with_memory("sphere:1e9", 8, {.bytes = 2048 * mebibyte, .scratch = folder_, .resume = true},
              [](const RankMemory& memory) { EXPECT_GE(memory.compared_copies(10 * cells, copies), copies / 32); });
}

TEST(NumberSet, GivesThePlacesOfItsNumbers) {
  NumberSet set(100'000);
  std::set<std::uint32_t> expected{0, 63, 64, 511, 512, 99'999};
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) expected.insert(static_cast<std::uint32_t>(random() % 100'000));
  for (const std::uint32_t number : expected) set.add(number);
  const std::vector<std::uint32_t> numbers = set.finish();
  ASSERT_TRUE(std::ranges::equal(numbers, expected));
  for (std::uint32_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(set.place(numbers[i]), i);
}

}  // namespace
}  // namespace lodestone
