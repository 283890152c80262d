// Builds by ranks that were interrupted: continued by any number of ranks, they come to the same bytes.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <random>

#include "parallel/distributed/generated_stream.h"
#include "tests/expect_error.h"
#include "tests/parallel/distributed/distributed.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;
using testing::Distributed;

class DistributedResume : public Distributed {
 protected:
  DistributedResume() {
    config_.build.cell_triangles = 20;
    config_.limit = {.scratch = folder_, .resume = true, .part = 700};
  }

  // Builds until call `at` of progress, as a full disk might end it at any moment; true if that was before the end.
  bool interrupted(const std::shared_ptr<const MeshStream>& stream, int at, int ranks, int threads) {
    std::atomic<int> calls = 0;
    on_progress_ = [&](int, const std::string&, double) {
      if (++calls == at) throw FileError("disk: cannot write: no space");
    };
    bool ended = false;
    try {
      const DistributedResult result = build(stream, ranks, threads, {.timeout_seconds = 5});
      resumed_ = 0;
      for (const RankReport& rank : result.ranks) resumed_ += rank.blocks_resumed;
      ended = true;
    } catch (const FileError&) {
    }
    on_progress_ = {};  // it refers to what ends here
    return !ended;
  }
  fs::path kept() const { return folder_ / "ranks.lode.scratch"; }

  std::uint64_t resumed_ = 0;
};

TEST_F(DistributedResume, InterruptedAnywhereItComesToTheSameBytes) {
  const fs::path path = mesh(test::raw_of(test::sphere_mesh(5)));
  const std::string expected = in_memory({path});
  fs::remove(folder_ / "expected.lode");
  const std::shared_ptr<const MeshStream> stream = open_mesh_stream(path);
  std::mt19937 random(1);
  std::uint64_t resumed = 0;
  for (int trial = 0; trial < 12; ++trial) {
    int interruptions = 0;
    const auto ranks = [&] { return 1 + static_cast<int>(random() % 4); };
    while (interrupted(stream, 1 + static_cast<int>(random() % 400), ranks(), trial % 2 * 2)) {
      EXPECT_FALSE(fs::exists(config_.output));
      if (++interruptions > 200) FAIL() << "never done";
    }
    resumed += resumed_;
    EXPECT_TRUE(expected == content(config_.output)) << trial;
    EXPECT_EQ(files(), 2u);  // the input and the output
    fs::remove(config_.output);
  }
  EXPECT_GT(resumed, 12u);
}

TEST_F(DistributedResume, BlocksGoToTheRanksThatHaveThemNow) {
  const std::shared_ptr<const MeshStream> stream = generated_stream(parse_generator("sphere:40000"));
  (void)interrupted(stream, -1, 1, 0);
  const std::string expected = content(config_.output);
  for (const std::array ranks : {std::array{4, 1}, std::array{1, 4}, std::array{3, 3}, std::array{2, 5}}) {
    fs::remove(config_.output);
    config_.output = folder_ / "missing" / "ranks.lode";  // where rank 0 fails when all blocks are done
    EXPECT_TRUE(interrupted(stream, -1, ranks[0], 0));
    config_.output = folder_ / "ranks.lode";
    EXPECT_FALSE(interrupted(stream, -1, ranks[1], 0));
    EXPECT_GT(resumed_, 10u);
    EXPECT_TRUE(expected == content(config_.output));
    EXPECT_EQ(files(), 1u);
  }
}

TEST_F(DistributedResume, TheBlocksOfAnotherBuildAreRefused) {
  const std::shared_ptr<const MeshStream> stream = open_mesh_stream(mesh(test::raw_of(test::sphere_mesh(4))));
  ASSERT_TRUE(interrupted(stream, 5, 3, 0));
  const auto refused = [&](const auto& change) {
    const DistributedConfig before = config_;
    change();
    expect_error_of<InputError>([&] { (void)build(stream, 2, 0); }, {"ranks.lode.scratch", "another", "remove it"});
    config_ = before;
  };
  refused([&] { config_.build.sigma0 = 0.5f; });
  refused([&] { config_.lattice = {12}; });
  refused([&] { config_.program = "another"; });
  EXPECT_FALSE(interrupted(stream, -1, 2, 0));
}

TEST_F(DistributedResume, FilesInUseAreRefused) {
  const std::shared_ptr<const MeshStream> stream = open_mesh_stream(mesh(test::raw_of(test::sphere_mesh(4))));
  std::atomic<bool> tried = false;
  on_progress_ = [&](int rank, const std::string& work, double) {
    if (rank != 1 || !work.starts_with("building level") || tried.exchange(true)) return;
    expect_error_of<ResourceError>([&] { (void)build(stream, 2, 0); }, {"ranks.lode.scratch", "another build"});
  };
  (void)build(stream, 2, 0, {.timeout_seconds = 30});
  EXPECT_TRUE(tried);
  EXPECT_EQ(files(), 2u);
}

TEST_F(DistributedResume, WithoutALimitNothingIsKept) {
  config_.limit = {.bytes = std::uint64_t{8} << 30, .scratch = folder_, .resume = true};
  const std::shared_ptr<const MeshStream> stream = open_mesh_stream(mesh(test::raw_of(test::sphere_mesh(4))));
  EXPECT_TRUE(interrupted(stream, 5, 3, 0));
  EXPECT_EQ(files(), 1u);
}

}  // namespace
}  // namespace lodestone
