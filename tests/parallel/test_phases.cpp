// Phases run in order, each complete before the next, for any number of workers.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <memory>
#include <stdexcept>
#include <vector>

#include "parallel/scheduler/phases.h"

namespace lodestone {
namespace {

std::vector<std::unique_ptr<Scheduler>> schedulers() {
  std::vector<std::unique_ptr<Scheduler>> out;
  out.push_back(make_serial_scheduler());
  for (const int threads : {1, 2, 5}) out.push_back(make_tbb_scheduler(threads));
  return out;
}

TEST(Phases, EveryItemFindsThePhasesBeforeComplete) {
  std::vector<std::size_t> ends;
  for (std::size_t phase = 0; phase < 300; ++phase) ends.push_back((ends.empty() ? 0 : ends.back()) + phase % 4);
  for (const auto& scheduler : schedulers()) {
    std::vector<int> calls(ends.back(), 0);
    std::atomic<std::size_t> done{0}, early{0};
    run_phases(*scheduler, ends, [&](std::size_t item) {
      std::size_t phase = 0;
      while (item >= ends[phase]) ++phase;
      if (phase > 0 && done < ends[phase - 1]) ++early;
      ++calls[item];
      ++done;
    });
    EXPECT_EQ(early, 0u);
    EXPECT_EQ(calls, std::vector<int>(ends.back(), 1));
  }
}

TEST(Phases, NothingToDoIsDone) {
  for (const auto& scheduler : schedulers()) {
    const auto never = [](std::size_t) { ADD_FAILURE(); };
    run_phases(*scheduler, {}, never);
    run_phases(*scheduler, std::array<std::size_t, 3>{0, 0, 0}, never);
  }
}

TEST(Phases, TheFirstExceptionEndsTheWork) {
  const std::array<std::size_t, 3> ends{10, 20, 30};
  for (const auto& scheduler : schedulers()) {
    std::atomic<bool> late{false};
    EXPECT_THROW(run_phases(*scheduler, ends,
                            [&](std::size_t item) {
                              if (item == 12) throw std::runtime_error("twelve");
                              if (item >= 20) late = true;
                            }),
                 std::runtime_error);
    EXPECT_FALSE(late);
  }
}

}  // namespace
}  // namespace lodestone
