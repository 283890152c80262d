// The work of a program as a trace of one worker tells it: tasks, what they wait for, and what nothing ran beside.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "parallel/scheduler/trace.h"

namespace lodestone {

// The work of one worker in one go: some seconds, then a call that others may help with, again and again.
struct RecordedTask {
  struct Step {
    double seconds = 0;  // processor time, at least 0
    int call = -1;       // number of the call that follows; -1: none, the task ends
  };
  std::string name;  // of the work, as the trace has it
  std::vector<Step> steps;
};

// A chunked loop or a graph of tasks: one call of a scheduler.
struct RecordedCall {
  std::vector<RecordedTask> tasks;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;  // (before, after), numbers of tasks
  double dispatch_seconds = 0;                                 // that the scheduler takes for each task
};

struct RecordedWork {
  std::vector<RecordedCall> calls;
  RecordedTask whole;  // what the thread did that made the calls
};

// The events of a trace of one worker that lie within [begin, end], in which the thread took `cpu_seconds`. Processor
// time outside events is dealt out to the gaps by their length; gaps between the tasks of a call are its scheduler's.
// Throws InputError for events of several workers, for events that overlap without being nested, and for a task of a
// graph that waits for one that is missing.
[[nodiscard]] RecordedWork recorded_work(std::span<const TraceEvent> events, double begin, double end,
                                         double cpu_seconds);

// Work, span and what the span consists of (brent1974).
struct WorkAndSpan {
  double work = 0;  // seconds of one worker
  double span = 0;  // seconds of as many as there may be: the longest chain
  // Seconds of the span by the name of the work, longest first. The name of what lies between calls is "before" that
  // of the call that follows, or "at the end".
  std::vector<std::pair<std::string, double>> critical;
};
[[nodiscard]] WorkAndSpan work_and_span(const RecordedWork& work);

// The name of a step of the whole program, see WorkAndSpan.
[[nodiscard]] std::string name_of_step(const RecordedWork& work, const RecordedTask::Step& step);

}  // namespace lodestone
