// Scaling figures and the cost of a phase.
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <thread>
#include <vector>

#include "core/base/error.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/metrics/cost/scaling.h"

namespace lodestone {
namespace {

// Amdahl's law with a serial share s takes s + (1 - s) / p: the serial fraction comes back.
TEST(Scaling, FindsTheSerialShareOfAmdahlsLaw) {
  for (const double serial : {0.0, 0.05, 0.3, 1.0}) {
    std::vector<ThreadTime> times;
    for (const int p : {4, 1, 2, 64}) times.push_back({p, 10 * (serial + (1 - serial) / p)});
    const std::vector<Scaling> rows = scaling(times);
    ASSERT_EQ(rows.size(), 4u);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double p = times[i].threads;
      EXPECT_EQ(rows[i].threads, times[i].threads);
      EXPECT_NEAR(rows[i].speedup, 1 / (serial + (1 - serial) / p), 1e-12);
      EXPECT_NEAR(rows[i].efficiency, rows[i].speedup / p, 1e-12);
      EXPECT_NEAR(rows[i].karp_flatt, rows[i].threads == 1 ? 0 : serial, 1e-12);
    }
  }
}

TEST(Scaling, ScaledSpeedUpCountsTheWork) {
  const std::vector<Scaling> rows = scaling(std::vector<ThreadTime>{{1, 2, 1}, {4, 2.5, 4}});
  EXPECT_NEAR(rows[1].speedup, 3.2, 1e-12);
  EXPECT_NEAR(rows[1].efficiency, 0.8, 1e-12);
  EXPECT_EQ(rows[1].karp_flatt, 0);
}

TEST(Scaling, MoreThanLinearIsNegative) {
  EXPECT_LT(scaling(std::vector<ThreadTime>{{1, 2}, {2, 0.9}})[1].karp_flatt, 0);
}

TEST(Scaling, RefusesWhatHasNoMeaning) {
  const auto refused = [](std::vector<ThreadTime> times) { EXPECT_THROW((void)scaling(times), InputError); };
  refused({});
  refused({{2, 1}});
  refused({{1, 1}, {2, 1}, {2, 1}});
  refused({{1, 1}, {1, 1}});
  refused({{1, 0}});
  refused({{1, 1}, {0, 1}});
  refused({{1, 1}, {2, -1}});
  refused({{1, 1}, {2, std::numeric_limits<double>::infinity()}});
  refused({{1, 1}, {2, 1, 0}});
}

TEST(Scaling, IntervalsHoldWhatRoundsGiveAndNarrowWithThem) {
  const std::vector<double> one{10, 10.5, 9.5, 10.2, 9.8}, two{5.2, 5.6, 5.0, 5.3, 5.1};
  const ScalingIntervals all = scaling_intervals(one, two, 2);
  EXPECT_LE(all.speedup.low, 10 / 5.2);
  EXPECT_GE(all.speedup.high, 10 / 5.2);
  EXPECT_GE(all.speedup.low, 9.5 / 5.6);
  EXPECT_LE(all.speedup.high, 10.5 / 5.0);
  EXPECT_NEAR(all.karp_flatt.low, 2 / all.speedup.high - 1, 1e-9);
  EXPECT_NEAR(all.karp_flatt.high, 2 / all.speedup.low - 1, 1e-9);
  EXPECT_EQ(scaling_intervals(one, two, 2).speedup.low, all.speedup.low) << "the same draws";
  const ScalingIntervals steady = scaling_intervals({10, 10, 10}, {5, 5, 5}, 2);
  EXPECT_EQ(steady.speedup.low, 2);
  EXPECT_EQ(steady.speedup.high, 2);
  EXPECT_EQ(scaling_intervals(one, one, 1).speedup.high, 1);
  EXPECT_EQ(scaling_intervals({1}, {1}, 4, 4).speedup.low, 4) << "as much work for each";
  EXPECT_THROW((void)scaling_intervals({}, two, 2), InputError);
  EXPECT_THROW((void)scaling_intervals(one, {0}, 2), InputError);
}

// Memory is touched, or it is not resident.
void use_memory(std::size_t bytes) {
  std::vector<char> block(bytes);
  for (std::size_t i = 0; i < bytes; i += 512) block[i] = 1;
  ASSERT_EQ(block[0], 1);
}

TEST(Cost, SeesThePeakOfItsPhase) {
  constexpr std::uint64_t mebibyte = 1 << 20;
  use_memory(256 * mebibyte);
  const std::uint64_t before = peak_resident_bytes();
  EXPECT_GT(before, 256 * mebibyte);
  const CostMeter meter;
  use_memory(64 * mebibyte);
  const Cost cost = meter.elapsed();
  EXPECT_GT(cost.peak_memory, 64 * mebibyte);
  if (cost.peak_of_phase) {
    EXPECT_LT(cost.peak_memory, before - 128 * mebibyte);
  } else {
    EXPECT_GE(cost.peak_memory, before);
  }
}

TEST(Cost, SeesWallAndProcessorTime) {
  const CostMeter idle;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const Cost rest = idle.elapsed();
  EXPECT_GE(rest.seconds, 0.05);
  EXPECT_LT(rest.cpu_seconds, 0.05);
  const CostMeter busy;
  volatile double sum = 0;
  while (busy.elapsed().cpu_seconds < 0.02)
    for (int i = 0; i < 100000; ++i) sum = sum + i;
  const Cost work = busy.elapsed();
  EXPECT_GE(work.cpu_seconds, 0.02);
  EXPECT_GE(work.seconds, 0.015);
  EXPECT_EQ(work.triangles + work.bytes + work.cells + work.draw_calls + work.vertices, 0u);
}

}  // namespace
}  // namespace lodestone
