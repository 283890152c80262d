// Traces as files: the JSON of Chrome's trace viewer (chrome://tracing, ui.perfetto.dev).
#pragma once

#include <string>

#include "parallel/scheduler/trace.h"

namespace lodestone {

// One complete event ("ph": "X") per chunk and task, one thread per worker; times in microseconds. Their "args" have
// the index, the processor time (cpu_us), and of a task of a graph what it worked on (place) and the tasks that it had
// to wait for (after), from which arrows lead to it. Written aside and renamed. Throws FileError.
void write_trace(const Trace& trace, const std::string& path);

}  // namespace lodestone
