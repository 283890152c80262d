// The scheduler contract, on both schedulers.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <numeric>
#include <random>
#include <stdexcept>
#include <thread>

#include "core/base/sort_unique.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {
namespace {

using Maker = std::unique_ptr<Scheduler> (*)();

class SchedulerContract : public testing::TestWithParam<Maker> {
 protected:
  std::unique_ptr<Scheduler> scheduler_ = GetParam()();
};

TEST_P(SchedulerContract, ChunksCoverTheRangeOnceWithFixedBorders) {
  for (const std::size_t count : {0u, 1u, 7u, 64u, 1000u}) {
    std::vector<std::atomic<int>> hits(count);
    std::vector<ChunkRange> chunks(chunk_count(count, 7));
    scheduler_->for_chunks(count, 7, [&](ChunkRange range) {
      chunks[range.index] = range;
      for (std::size_t i = range.begin; i < range.end; ++i) ++hits[i];
    });
    for (const auto& hit : hits) EXPECT_EQ(hit, 1);
    for (std::size_t k = 0; k < chunks.size(); ++k) {
      EXPECT_EQ(chunks[k].begin, k * 7);
      EXPECT_EQ(chunks[k].end, std::min<std::size_t>(k * 7 + 7, count));
    }
  }
}

TEST_P(SchedulerContract, WorkerIndicesStayInRange) {
  std::atomic<bool> in_range{true};
  scheduler_->for_chunks(1000, 1, [&](ChunkRange) {
    const int index = scheduler_->worker_index();
    if (index < 0 || index >= scheduler_->workers()) in_range = false;
  });
  EXPECT_TRUE(in_range);
}

TEST_P(SchedulerContract, ChunkExceptionsComeOut) {
  EXPECT_THROW(scheduler_->for_chunks(100, 1,
                                      [](ChunkRange r) {
                                        if (r.begin == 50) throw std::runtime_error("stop");
                                      }),
               std::runtime_error);
}

TaskGraph random_graph(std::uint32_t tasks, unsigned seed) {
  std::mt19937 random(seed);
  TaskGraph graph{tasks, {}, {}};
  for (std::uint32_t after = 1; after < tasks; ++after)
    for (std::uint32_t k = 0; k < random() % 4; ++k) graph.edges.emplace_back(random() % after, after);
  sort_unique(graph.edges);
  return graph;
}

TEST_P(SchedulerContract, GraphRunsEveryTaskOnceAfterItsPredecessors) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    TaskGraph graph = random_graph(200, seed);
    if (seed % 2) {
      graph.priority.resize(graph.task_count);
      std::iota(graph.priority.begin(), graph.priority.end(), 1);
    }
    std::vector<std::atomic<int>> order(graph.task_count);
    std::atomic<int> next{1};
    scheduler_->run_graph(graph, [&](std::uint32_t task) { order[task] = next++; });
    for (const auto& o : order) EXPECT_GT(o, 0);
    EXPECT_EQ(next, 201);
    for (const auto& [before, after] : graph.edges) EXPECT_LT(order[before], order[after]);
  }
}

TEST_P(SchedulerContract, GraphExceptionsComeOutAndStopSuccessors) {
  TaskGraph graph{3, {{0, 1}, {1, 2}}, {}};
  std::atomic<bool> last_ran{false};
  EXPECT_THROW(scheduler_->run_graph(graph,
                                     [&](std::uint32_t task) {
                                       if (task == 1) throw std::runtime_error("stop");
                                       if (task == 2) last_ran = true;
                                     }),
               std::runtime_error);
  EXPECT_FALSE(last_ran);
}

TEST_P(SchedulerContract, CancellationThrowsCancelled) {
  CancelFlag cancel{false};
  std::atomic<int> ran{0};
  EXPECT_THROW(scheduler_->run_graph(
                   {50, {{0, 1}, {1, 2}, {2, 3}}, {}},
                   [&](std::uint32_t task) {
                     ++ran;
                     if (task == 0) cancel = true;
                   },
                   &cancel),
               Cancelled);
  EXPECT_LT(ran, 50);
}

TEST_P(SchedulerContract, NestedLoopsFinish) {
  std::atomic<int> sum{0};
  scheduler_->for_chunks(10, 1, [&](ChunkRange) { scheduler_->for_chunks(10, 1, [&](ChunkRange) { ++sum; }); });
  EXPECT_EQ(sum, 100);
}

// A body's worker does nothing else until the body ends, also while it waits for a loop within: its scratch memory is
// its own.
TEST_P(SchedulerContract, NestedLoopsKeepTheScratchOfTheirWorker) {
  std::vector<std::size_t> scratch(static_cast<std::size_t>(scheduler_->workers()));
  std::atomic<int> overwritten{0};
  const auto body = [&](std::size_t number) {
    const auto worker = static_cast<std::size_t>(scheduler_->worker_index());
    scratch[worker] = number;
    scheduler_->for_chunks(8, 1, [](ChunkRange) { std::this_thread::sleep_for(std::chrono::microseconds(200)); });
    if (scratch[worker] != number) ++overwritten;
  };
  scheduler_->for_chunks(100, 1, [&](ChunkRange range) { body(range.index); });
  EXPECT_EQ(overwritten, 0);
  scheduler_->run_graph({100, {}, {}}, body);
  EXPECT_EQ(overwritten, 0);
}

// True if all workers of a scheduler run at the same time: a body for each of them waits for all.
bool all_come(Scheduler& scheduler) {
  const int workers = scheduler.workers();
  std::atomic<int> here{0};
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  scheduler.for_chunks(static_cast<std::size_t>(workers), 1, [&](ChunkRange) {
    ++here;
    while (here < workers && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  return std::chrono::steady_clock::now() < deadline;
}

// Maximum number of bodies of a scheduler that run at once.
int most_at_once(Scheduler& scheduler) {
  std::atomic<int> here{0}, most{0};
  scheduler.for_chunks(200, 1, [&](ChunkRange) {
    const int now = ++here;
    for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
    }
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    --here;
  });
  return most;
}

TEST(TbbScheduler, KeepsItsWidthBesideOthers) {
  const auto wide = make_tbb_scheduler(7);
  EXPECT_TRUE(all_come(*wide));
  const auto narrow = make_tbb_scheduler(1);
  EXPECT_TRUE(all_come(*wide));
  {
    const auto wider = make_tbb_scheduler(9);
    EXPECT_TRUE(all_come(*wider));
    EXPECT_TRUE(all_come(*wide));
  }
  EXPECT_TRUE(all_come(*wide));
  EXPECT_EQ(most_at_once(*narrow), 1);
}

TEST(TbbScheduler, WorksAtTheSameTimeAsOthers) {
  const auto three = make_tbb_scheduler(3), five = make_tbb_scheduler(5);
  std::atomic<int> most_of_three{0};
  std::thread beside([&] { most_of_three = most_at_once(*three); });
  EXPECT_LE(most_at_once(*five), five->workers());
  beside.join();
  EXPECT_LE(most_of_three, three->workers());
  EXPECT_TRUE(all_come(*three));
  EXPECT_TRUE(all_come(*five));
}

INSTANTIATE_TEST_SUITE_P(All, SchedulerContract,
                         testing::Values([] { return make_serial_scheduler(); }, [] { return make_tbb_scheduler(1); },
                                         [] { return make_tbb_scheduler(2); }, [] { return make_tbb_scheduler(7); }));

}  // namespace
}  // namespace lodestone
