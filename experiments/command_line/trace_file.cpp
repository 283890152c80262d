#include "experiments/command_line/trace_file.h"

#include <nlohmann/json.hpp>
#include <span>

#include "core/files/atomic_file.h"

namespace lodestone {

void write_trace(const Trace& trace, const std::string& path) {
  nlohmann::json events = nlohmann::json::array();
  for (int worker = 0; worker < trace.workers(); ++worker)
    events.push_back({{"name", "thread_name"},
                      {"ph", "M"},
                      {"pid", 1},
                      {"tid", worker},
                      {"args", {{"name", "worker " + std::to_string(worker)}}}});
  for (const TraceEvent& e : trace.events())
    events.push_back({{"name", e.name},
                      {"ph", "X"},
                      {"pid", 1},
                      {"tid", e.worker},
                      {"ts", e.begin * 1e6},
                      {"dur", (e.end - e.begin) * 1e6},
                      {"args", {{"index", e.index}}}});
  const std::string text = nlohmann::json{{"displayTimeUnit", "ms"}, {"traceEvents", std::move(events)}}.dump();
  AtomicFile file(path);
  file.write(std::as_bytes(std::span(text)));
  file.commit();
}

}  // namespace lodestone
