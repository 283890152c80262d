// Traces as files: the JSON of Chrome's trace viewer (chrome://tracing, ui.perfetto.dev).
#pragma once

#include <string>
#include <vector>

#include "core/files/json.h"
#include "parallel/scheduler/trace.h"

namespace lodestone {

// One complete event ("ph": "X") per chunk and task, one thread per worker; times in microseconds. Their "args" have
// the index, the processor time (cpu_us), and of a task of a graph what it worked on (place) and the tasks that it had
// to wait for (after), from which arrows lead to it. Written aside and renamed. Throws FileError.
void write_trace(const Trace& trace, const std::string& path);

// The same of several processes, each of which lists its own events under its number and name. Threads beyond the
// workers are named by `others`.
[[nodiscard]] Json trace_events(const Trace& trace, int process, const std::string& name,
                                const std::vector<std::string>& others);
// `lists`: the events of a process each, as the text of an array.
void write_trace_events(const std::vector<std::string>& lists, const std::string& path);

}  // namespace lodestone
