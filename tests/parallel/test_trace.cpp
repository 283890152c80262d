// The tracing scheduler: behaves as the one it wraps, and writes down all that ran.
#include <gtest/gtest.h>

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
