// A build by several ranks, which are threads here, and the same one in memory.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "core/base/byte_size.h"
#include "parallel/distributed/building/build_distributed.h"
#include "parallel/distributed/messages/local_transport.h"
#include "parallel/out_of_core/build_model.h"
#include "tests/parallel/stream_meshes.h"
#include "tests/test_folder.h"

namespace lodestone::testing {

namespace fs = std::filesystem;

// The limit in "give --memory-limit NMiB".
inline std::uint64_t least_in(const std::string& message) {
  const std::string option = "--memory-limit ";
  return std::stoull(message.substr(message.find(option) + option.size())) * mebibyte;
}

class Distributed : public FolderTest {
 protected:
  Distributed() {
    config_.build.cell_triangles = 100;
    config_.build.sigma0 = 1;
    config_.output = folder_ / "ranks.lode";
  }

  // The file that comes of building in memory.
  std::string in_memory(const std::vector<fs::path>& files) const {
    const auto scheduler = make_tbb_scheduler(2);
    ModelConfig config{.build = config_.build, .output = folder_ / "expected.lode", .lattice = config_.lattice};
    config.texture_copies = config_.texture_copies;
    (void)build_model(ModelSource{files, reading_}, config, *scheduler);
    return content(config.output);
  }

  DistributedResult build(const OpenInput& input, int ranks, int threads, const LocalRanksConfig& local = {}) const {
    DistributedResult first;
    run_local_ranks(
        ranks,
        [&](Transport& transport) {
          const auto scheduler = threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
          Ranks all(transport, most_direct_);
          if (on_progress_)
            all.show([&](const std::string& work, double share) { on_progress_(transport.rank(), work, share); });
          DistributedResult result = build_distributed(input, config_, all, *scheduler);
          if (transport.rank() == 0) first = std::move(result);
        },
        local);
    return first;
  }
  DistributedResult build(std::shared_ptr<const MeshStream> stream, int ranks, int threads,
                          const LocalRanksConfig& local = {}) const {
    return build([&](Ranks& all, Scheduler&) { return shared_out(stream, all.count()); }, ranks, threads, local);
  }
  std::string built(const std::vector<fs::path>& files, int ranks, int threads) const {
    (void)build([&](Ranks& all, Scheduler& scheduler) { return open_rank_input(files, reading_, all, scheduler); },
                ranks, threads);
    return content(config_.output);
  }
  // From any number of ranks, and of threads in each.
  void expect_same(const std::vector<fs::path>& files) const {
    const std::string expected = in_memory(files);
    ASSERT_FALSE(expected.empty());
    for (const int ranks : {1, 2, 3, 5, 8})
      for (const int threads : {0, 2})
        EXPECT_TRUE(built(files, ranks, threads) == expected) << ranks << " ranks, " << threads << " threads";
  }

  void expect_same(const fs::path& file) const { expect_same(std::vector{file}); }

  fs::path mesh(const RawMesh& raw) const {
    test::write_ply(folder_ / "m.ply", raw);
    return folder_ / "m.ply";
  }

  DistributedConfig config_;
  ReadConfig reading_{.attributes = false};
  int most_direct_ = 48;                                                              // ranks that exchange directly
  std::function<void(int rank, const std::string& work, double share)> on_progress_;  // by several threads
};

}  // namespace lodestone::testing
