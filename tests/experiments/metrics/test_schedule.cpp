// Recorded work, its span, and its replay on virtual workers.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "core/base/error.h"
#include "core/base/sort_unique.h"
#include "experiments/metrics/schedule/list_schedule.h"

namespace lodestone {
namespace {

TraceEvent event(std::string name, std::uint32_t call, std::uint64_t index, double begin, double end) {
  TraceEvent e{.name = std::move(name), .index = index, .begin = begin, .end = end, .cpu_seconds = end - begin};
  e.call = call;
  return e;
}

// The whole program is one call of a graph: tasks of these seconds.
RecordedWork flat(std::vector<double> seconds, std::vector<std::pair<std::uint32_t, std::uint32_t>> edges = {}) {
  RecordedWork work;
  RecordedCall call;
  for (const double s : seconds) call.tasks.push_back({"task", {{s, -1}}});
  call.edges = std::move(edges);
  work.calls.push_back(std::move(call));
  work.whole = {"", {{0, 0}, {0, -1}}};
  return work;
}

double seconds(const RecordedWork& work, int workers) { return list_schedule(work, {workers, 1}).seconds; }

TEST(RecordedWork, TellsCallsGapsAndNestedCalls) {
  std::vector<TraceEvent> events{event("a", 1, 0, 1, 2), event("a", 1, 1, 2.5, 3.5), event("inner", 3, 0, 5, 5.5),
                                 event("inner", 3, 1, 5.5, 6), event("b", 2, 0, 4.5, 7)};
  const RecordedWork work = recorded_work(events, 0, 8, 7);  // half of a second less in the gaps than they take
  ASSERT_EQ(work.whole.steps.size(), 3u);
  const double scale = (7 - 2 - 2.5) / (8 - 2 - 2.5);
  EXPECT_NEAR(work.whole.steps[0].seconds, scale * 1, 1e-12);
  EXPECT_NEAR(work.whole.steps[1].seconds, scale * 1, 1e-12);
  EXPECT_NEAR(work.whole.steps[2].seconds, scale * 1, 1e-12);
  const RecordedCall& a = work.calls[static_cast<std::size_t>(work.whole.steps[0].call)];
  EXPECT_EQ(a.tasks.size(), 2u);
  EXPECT_NEAR(a.dispatch_seconds, scale * 0.25, 1e-12);
  const RecordedCall& b = work.calls[static_cast<std::size_t>(work.whole.steps[1].call)];
  ASSERT_EQ(b.tasks.size(), 1u);
  ASSERT_EQ(b.tasks[0].steps.size(), 2u);
  EXPECT_NEAR(b.tasks[0].steps[0].seconds, 0.5, 1e-12);
  EXPECT_NEAR(b.tasks[0].steps[1].seconds, 1, 1e-12);
  EXPECT_EQ(work.calls[static_cast<std::size_t>(b.tasks[0].steps[0].call)].tasks.size(), 2u);
  const WorkAndSpan of = work_and_span(work);
  EXPECT_NEAR(of.work, 7, 1e-12);
  EXPECT_NEAR(of.span, 7 - 1 - scale * 0.25 - 0.5, 1e-12) << "one of two chunks, twice";
  EXPECT_EQ(of.critical.front().first, "b");
  EXPECT_NEAR(seconds(work, 1), of.work, 1e-12);
  EXPECT_NEAR(seconds(work, 2), of.span, 1e-12);
}

TEST(RecordedWork, KeepsTheOrderOfGraphs) {
  std::vector<TraceEvent> events{event("late", 1, 0, 2, 3), event("early", 1, 2, 0, 1), event("other", 1, 1, 1, 2)};
  for (TraceEvent& e : events) e.in_graph = true;
  events[0].after = {1, 2};
  const RecordedWork work = recorded_work(events, 0, 3, 3);
  EXPECT_NEAR(work_and_span(work).span, 2, 1e-12);
  EXPECT_EQ(list_schedule(work, {2, 1}).seconds, 2);
  events[0].after = {7};
  EXPECT_THROW((void)recorded_work(events, 0, 3, 3), InputError);
}

TEST(RecordedWork, RefusesWhatTellsNoOrder) {
  std::vector<TraceEvent> events{event("a", 1, 0, 0, 2), event("b", 2, 0, 1, 3)};
  EXPECT_THROW((void)recorded_work(events, 0, 3, 3), InputError) << "they overlap";
  events[1] = event("b", 2, 0, 2, 3);
  EXPECT_NO_THROW((void)recorded_work(events, 0, 3, 3));
  events[1].worker = 1;
  EXPECT_THROW((void)recorded_work(events, 0, 3, 3), InputError);
}

// A real trace: one worker replays what it did.
TEST(RecordedWork, OneWorkerTakesWhatWasRecorded) {
  const auto trace = std::make_shared<Trace>(1);
  const auto scheduler = make_tracing_scheduler(make_tbb_scheduler(1), trace);
  const auto spin = [](double s) {
    const Stopwatch clock;
    while (clock.seconds() < s) continue;
  };
  const double begin = trace->now();
  const CpuClock clock;
  scheduler->name_work("loop");
  scheduler->for_chunks(8, 1, [&](ChunkRange) { spin(1e-3); });
  scheduler->run_graph({4, {{0, 1}, {1, 2}}, {}, {}},
                       [&](std::uint32_t) { scheduler->for_chunks(2, 1, [&](ChunkRange) { spin(1e-3); }); });
  const double cpu = clock.elapsed().cpu_seconds;
  const RecordedWork work = recorded_work(trace->events(), begin, trace->now(), cpu);
  EXPECT_EQ(work.calls.size(), 6u);
  EXPECT_NEAR(work_and_span(work).work, cpu, 1e-3 * cpu + 1e-5);
  EXPECT_NEAR(seconds(work, 1), work_and_span(work).work, 1e-9);
  EXPECT_GT(work_and_span(work).work / work_and_span(work).span, 2);
}

// A slow twin for one call: at every moment every idle worker takes the first task that is ready.
double obvious(const RecordedCall& call, int workers) {
  std::set<std::uint32_t> left, done;
  for (std::uint32_t t = 0; t < call.tasks.size(); ++t) left.insert(t);
  std::map<std::uint32_t, double> running;  // until when
  double now = 0;
  while (!left.empty() || !running.empty()) {
    for (auto t = left.begin(); t != left.end() && std::ssize(running) < workers;) {
      const bool ready = std::ranges::all_of(
          call.edges, [&](const auto& edge) { return edge.second != *t || done.contains(edge.first); });
      if (ready)
        running[*t] = now + call.tasks[*t].steps[0].seconds + call.dispatch_seconds, t = left.erase(t);
      else
        ++t;
    }
    const auto next = std::ranges::min_element(running, {}, [](const auto& r) { return r.second; });
    now = next->second;
    done.insert(next->first);
    running.erase(next);
  }
  return now;
}

TEST(ListSchedule, IsThatOfTheObviousOneAndWithinBrentsBounds) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> times(1 + random() % 40);
    for (double& t : times) t = static_cast<double>(1 + random() % 1000) + 1e-3 * static_cast<double>(random() % 1000);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::uint32_t t = 1; t < times.size(); ++t)
      for (std::uint32_t e = 0; e < random() % 3; ++e) edges.emplace_back(random() % t, t);
    sort_unique(edges);
    RecordedWork work = flat(times, edges);
    work.calls[0].dispatch_seconds = 0.25;
    const auto [all, span, critical] = work_and_span(work);
    for (const int workers : {1, 2, 3, 8, 1000}) {
      const double s = seconds(work, workers);
      EXPECT_NEAR(s, obvious(work.calls[0], workers), 1e-9 * s) << trial << ' ' << workers;
      EXPECT_GE(s, std::max(all / workers, span) * (1 - 1e-12));
      EXPECT_LE(s, (all - span) / workers + span + 1e-9 * all);
    }
  }
}

TEST(ListSchedule, AmdahlsLaw) {
  RecordedWork work = flat(std::vector<double>(64, 1.0));
  work.whole.steps[0].seconds = 16;
  for (const int workers : {1, 4, 64}) EXPECT_NEAR(seconds(work, workers), 16 + 64.0 / workers, 1e-12);
  const Schedule many = list_schedule(work, {64, 1});
  ASSERT_FALSE(many.idle.empty());
  EXPECT_EQ(many.idle.front().first, "before task");
  EXPECT_NEAR(many.idle.front().second, 16.0 * 63, 1e-9);
  EXPECT_NEAR(list_schedule(work, {4, 1.5}).seconds, 16 + 1.5 * 16, 1e-12) << "what runs alone is not slowed";
}

// The first worker has done its chunk after a second and waits until 10.5 for the second one, which has the other; the
// third one is busy from 3 to 11. The last task is ready at 3 and begins at 10.5.
TEST(ListSchedule, WhoWaitsForACallTakesNothingElse) {
  RecordedWork work;
  RecordedCall inner, outer;
  inner.tasks = {{"in", {{1, -1}}}, {"in", {{10, -1}}}};
  outer.tasks = {{"out", {{0, 0}, {0, -1}}}, {"out", {{0.5, -1}}}, {"out", {{3, -1}}}};
  outer.tasks.insert(outer.tasks.end(), 2, {"out", {{8, -1}}});
  outer.edges = {{2, 3}, {2, 4}};
  work.calls = {inner, outer};
  work.whole = {"", {{0, 1}, {0, -1}}};
  EXPECT_NEAR(seconds(work, 3), 18.5, 1e-12);
  EXPECT_NEAR(seconds(work, 1), 30.5, 1e-12);
  EXPECT_NEAR(seconds(work, 5), 11, 1e-12);
}

TEST(ListSchedule, RefusesWhatIsNoMachine) {
  const RecordedWork work = flat({1});
  EXPECT_THROW((void)list_schedule(work, {0, 1}), InputError);
  EXPECT_THROW((void)list_schedule(work, {1, 0.5}), InputError);
  EXPECT_EQ(seconds(work, 1 << 20), 1);
}

}  // namespace
}  // namespace lodestone
