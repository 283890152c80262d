// A record of what each worker did when: a scheduler that notes every chunk and every task of the one that it wraps.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct TraceEvent {
  std::string name;         // what name_work() said, or the label of the task
  std::uint64_t index = 0;  // of the chunk or task
  int worker = 0;
  double begin = 0, end = 0;  // seconds since the trace began
  double cpu_seconds = 0;     // of the worker's thread in between
  std::uint32_t call = 0;     // of the scheduler, that it is part of: 1 for the first that began, and so on
  // For tasks of a graph only:
  bool in_graph = false;
  std::string place{};                 // what it worked on, as the graph says
  std::vector<std::uint32_t> after{};  // tasks of the graph that it had to wait for, ascending
};

// Use of the workers between the first event of some work and its last.
struct TraceSummary {
  double seconds = 0;    // wall
  double busy = 0;       // share of workers x seconds that lies inside events
  double idle_tail = 0;  // seconds at the end in which at least one worker had nothing left to do
};

class Trace {
 public:
  explicit Trace(int workers);
  [[nodiscard]] double now() const { return clock_.seconds(); }
  // Events of one worker do not come from two threads at once.
  void record(TraceEvent event);
  // By worker, then by the order in which they ended. Not while a scheduler records.
  [[nodiscard]] std::vector<TraceEvent> events() const;
  [[nodiscard]] int workers() const { return static_cast<int>(by_worker_.size()); }

 private:
  Stopwatch clock_;
  std::vector<std::vector<TraceEvent>> by_worker_;
};

// Summarizes the events that begin in [from, until). Nested events count once.
[[nodiscard]] TraceSummary summarize(const Trace& trace, double from = 0,
                                     double until = std::numeric_limits<double>::infinity());

// Behaves as `inner` does. Costs two looks at two clocks and one record for each chunk and task.
[[nodiscard]] std::unique_ptr<Scheduler> make_tracing_scheduler(std::unique_ptr<Scheduler> inner,
                                                                std::shared_ptr<Trace> trace);

}  // namespace lodestone
