// Builds out of core that were interrupted: continued, they come to the same bytes.
#include <array>
#include <atomic>
#include <random>

#include "core/base/error.h"
#include "tests/parallel/out_of_core/out_of_core.h"

namespace lodestone {
namespace {

using namespace testing;

// Throws at its n-th call of progress, as a full disk might at any moment.
struct Interrupted {};

class Resume : public OutOfCore {
 protected:
  // Builds until call `at` of progress, or until the first one of a step; true if that was before the end.
  bool interrupted(const fs::path& path, int at, int threads, const std::string& last_step = {}) {
    const auto scheduler = threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
    std::atomic<int> calls = 0;
    config_.progress = [&](const ModelProgress& now) {
      if (++calls == at || now.step == last_step) throw Interrupted{};
    };
    try {
      const ModelResult result = build(path, *scheduler);
      resumed_ = result.blocks_resumed;
      return false;
    } catch (const Interrupted&) {
      return true;
    }
  }
  std::uint64_t resumed_ = 0;
};

TEST_F(Resume, InterruptedAnywhereItComesToTheSameBytes) {
  const fs::path path = sphere();
  const std::string expected = in_memory(path);
  config_.resume = true;
  std::mt19937 random(1);
  std::uint64_t resumed = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const int threads = std::array{0, 1, 2, 7}[static_cast<std::size_t>(trial) % 4];
    int interruptions = 0;
    while (interrupted(path, 1 + static_cast<int>(random() % 40), threads)) {
      ++interruptions;
      EXPECT_FALSE(fs::exists(folder_ / "m.lode"));
      EXPECT_TRUE(fs::exists(folder_ / "m.lode.scratch" / "journal"));
      if (interruptions > 200) FAIL() << "never done";
    }
    resumed += resumed_;
    EXPECT_TRUE(expected == content(folder_ / "m.lode")) << trial;
    EXPECT_EQ(files(), (std::vector<std::string>{"expected.lode", "m.lode", "m.ply"}));
    fs::remove(folder_ / "m.lode");
  }
  EXPECT_GT(resumed, 30u);
}

TEST_F(Resume, WithoutItNothingIsLeft) {
  const fs::path path = sphere();
  for (const int at : {1, 5, 20}) {
    EXPECT_TRUE(interrupted(path, at, 2));
    EXPECT_EQ(files(), (std::vector<std::string>{"m.ply"}));
  }
}

TEST_F(Resume, CancelledAndContinued) {
  const fs::path path = sphere();
  config_.resume = true;
  CancelFlag cancel{true};
  config_.build.cancel = &cancel;
  const auto scheduler = make_tbb_scheduler(2);
  EXPECT_THROW((void)build(path, *scheduler), Cancelled);
  cancel = false;
  EXPECT_TRUE(in_memory(path) == built(path));
}

// Whatever the end of the journal looks like: what it does not say is done again.
TEST_F(Resume, DamagedJournalsAreBelievedAsFarAsTheyAreSound) {
  const fs::path path = sphere();
  const std::string expected = in_memory(path);
  config_.resume = true;
  const fs::path journal = folder_ / "m.lode.scratch" / "journal";
  std::mt19937 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    ASSERT_TRUE(interrupted(path, -1, 2, "writing"));
    std::string bytes = content(journal);
    if (trial % 2 == 0) {
      bytes.resize(200 + random() % (bytes.size() - 200));
    } else {
      bytes[200 + random() % (bytes.size() - 200)] ^= 4;
    }
    std::ofstream(journal, std::ios::binary) << bytes;
    EXPECT_FALSE(interrupted(path, -1, 2));
    EXPECT_TRUE(expected == content(folder_ / "m.lode")) << trial;
  }
}

TEST_F(Resume, RefusesWorkOfAnotherBuild) {
  const fs::path path = sphere();
  config_.resume = true;
  ASSERT_TRUE(interrupted(path, -1, 2, "writing"));
  const auto refused = [&](auto change) {
    const ModelConfig before = config_;
    change();
    EXPECT_THROW((void)interrupted(path, -1, 2), InputError);
    config_ = before;
  };
  refused([&] { config_.build.sigma0 = 0.9f; });
  refused([&] { config_.build.cell_triangles = 101; });
  refused([&] { config_.build.finest_level = 2; });
  refused([&] { config_.build.simplifier = "cluster"; });
  refused([&] { config_.build.placement = Placement::endpoint; });
  refused([&] { config_.lattice.bits = 20; });
  refused([&] { config_.program = "another"; });
  refused([&] { (void)mesh(test::raw_of(test::torus_mesh(80, 80))); });
  (void)mesh(test::raw_of(test::sphere_mesh(5)));  // the same bytes, but another time
  EXPECT_THROW((void)interrupted(path, -1, 2), InputError);
}

TEST_F(Resume, TwoBuildsDoNotShareTheirFiles) {
  const fs::path path = sphere();
  config_.resume = true;
  config_.program = "1";
  bool refused = false;
  config_.progress = [&, inner = false](const ModelProgress&) mutable {
    if (std::exchange(inner, true)) return;
    ModelConfig other = config_;
    other.progress = {};
    const auto serial = make_serial_scheduler();
    try {
      (void)build(path, other, *serial);
    } catch (const ResourceError&) {
      refused = true;
    }
  };
  EXPECT_TRUE(in_memory(path) == built(path));
  EXPECT_TRUE(refused);
}

}  // namespace
}  // namespace lodestone
