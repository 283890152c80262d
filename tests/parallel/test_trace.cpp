// The tracing scheduler: behaves as the one it wraps, and writes down all that ran.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <stdexcept>

#include "parallel/scheduler/trace.h"

namespace lodestone {
namespace {

TEST(Trace, HoldsEveryChunkUnderItsName) {
  const auto trace = std::make_shared<Trace>(2);
  const auto scheduler = make_tracing_scheduler(make_tbb_scheduler(2), trace);
  scheduler->name_work("first");
  scheduler->for_chunks(10, 3, [](ChunkRange) {});
  scheduler->name_work("second");
  scheduler->for_chunks(2, 1, [](ChunkRange) {});
  std::multiset<std::pair<std::string, std::uint64_t>> seen;
  for (const TraceEvent& e : trace->events()) {
    seen.emplace(e.name, e.index);
    EXPECT_LE(e.begin, e.end);
    EXPECT_LT(e.worker, 2);
  }
  EXPECT_EQ(seen, (std::multiset<std::pair<std::string, std::uint64_t>>{
                      {"first", 0}, {"first", 1}, {"first", 2}, {"first", 3}, {"second", 0}, {"second", 1}}));
}

TEST(Trace, LabelsTasksAndKeepsTheirOrder) {
  const auto trace = std::make_shared<Trace>(1);
  const auto scheduler = make_tracing_scheduler(make_serial_scheduler(), trace);
  TaskGraph graph{3, {{2, 1}, {1, 0}}, {}, [](std::uint32_t task) { return "task " + std::to_string(task); }};
  scheduler->run_graph(graph, [](std::uint32_t) {});
  const auto events = trace->events();
  ASSERT_EQ(events.size(), 3u);
  EXPECT_EQ(events[0].name, "task 2");
  EXPECT_EQ(events[2].name, "task 0");
  EXPECT_LE(events[0].end, events[1].begin);
}

TEST(Trace, TasksSayWhatTheyWaitedForAndWorkedOn) {
  for (const int threads : {1, 3}) {
    const auto trace = std::make_shared<Trace>(threads);
    const auto scheduler = make_tracing_scheduler(make_tbb_scheduler(threads), trace);
    const TaskGraph graph{.task_count = 4,
                          .edges = {{3, 0}, {1, 0}, {2, 1}},
                          .priority = {},
                          .label = {},
                          .place = [](std::uint32_t task) { return "place " + std::to_string(task); }};
    scheduler->for_chunks(1, 1, [](ChunkRange) {});
    for (int run = 0; run < 2; ++run) scheduler->run_graph(graph, [](std::uint32_t) {});
    std::set<std::pair<std::uint32_t, std::uint64_t>> seen;
    for (const TraceEvent& e : trace->events()) {
      EXPECT_EQ(e.place, e.in_graph ? "place " + std::to_string(e.index) : "");
      EXPECT_EQ(e.after, !e.in_graph    ? std::vector<std::uint32_t>{}
                         : e.index == 0 ? (std::vector<std::uint32_t>{1, 3})
                         : e.index == 1 ? (std::vector<std::uint32_t>{2})
                                        : std::vector<std::uint32_t>{});
      if (e.in_graph) seen.emplace(e.call, e.index);
    }
    EXPECT_EQ(seen.size(), 8u) << "four tasks in each of two graphs";
  }
}

TEST(Trace, NumbersCallsAlsoThoseOfBodies) {
  const auto trace = std::make_shared<Trace>(1);
  const auto scheduler = make_tracing_scheduler(make_serial_scheduler(), trace);
  scheduler->for_chunks(2, 1, [&](ChunkRange) { scheduler->for_chunks(3, 1, [](ChunkRange) {}); });
  std::map<std::uint32_t, int> events;
  for (const TraceEvent& e : trace->events()) ++events[e.call];
  EXPECT_EQ(events, (std::map<std::uint32_t, int>{{1, 2}, {2, 3}, {3, 3}}));
}

TEST(Trace, ProcessorTimeIsThatOfTheWork) {
  const auto trace = std::make_shared<Trace>(1);
  const auto scheduler = make_tracing_scheduler(make_serial_scheduler(), trace);
  scheduler->for_chunks(2, 1, [](ChunkRange chunk) {
    const double until = thread_cpu_seconds() + (chunk.index == 0 ? 0.02 : 0);
    while (thread_cpu_seconds() < until) continue;
  });
  const auto events = trace->events();
  EXPECT_GE(events[0].cpu_seconds, 0.02);
  EXPECT_LT(events[1].cpu_seconds, 0.02);
  EXPECT_GE(events[1].cpu_seconds, 0);
}

TEST(Trace, LetsExceptionsAndCancellationThrough) {
  const auto scheduler = make_tracing_scheduler(make_tbb_scheduler(2), std::make_shared<Trace>(2));
  EXPECT_THROW(scheduler->for_chunks(3, 1, [](ChunkRange) { throw std::runtime_error("stop"); }), std::runtime_error);
  const CancelFlag cancel = true;
  EXPECT_THROW(scheduler->run_graph(
                   {1, {}, {}, {}}, [](std::uint32_t) {}, &cancel),
               Cancelled);
}

TEST(Trace, SummaryCountsNestedWorkOnceAndTheTail) {
  Trace trace(2);
  trace.record({"early", 0, 0, 0, 1});
  trace.record({"inner", 0, 0, 2.5, 3});
  trace.record({"outer", 0, 0, 2, 4});
  trace.record({"other", 0, 1, 2, 3});
  const TraceSummary whole = summarize(trace, 2);
  EXPECT_DOUBLE_EQ(whole.seconds, 2);
  EXPECT_DOUBLE_EQ(whole.busy, 0.75);
  EXPECT_DOUBLE_EQ(whole.idle_tail, 1);
  EXPECT_DOUBLE_EQ(summarize(trace, 9).seconds, 0);
}

}  // namespace
}  // namespace lodestone
