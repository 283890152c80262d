#include "experiments/command_line/trace_file.h"

#include <map>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/files/atomic_file.h"
#include "core/files/json.h"

namespace lodestone {
namespace {

Json arguments_of(const TraceEvent& event) {
  Json arguments{{"index", event.index}, {"cpu_us", event.cpu_seconds * 1e6}};
  if (!event.place.empty()) arguments["place"] = event.place;
  if (event.in_graph) arguments["after"] = event.after;
  return arguments;
}

// Arrows from the end of each task that was waited for to the begin of the one that waited.
void add_arrows(const std::vector<TraceEvent>& events, int process, Json& list) {
  std::map<std::pair<std::uint32_t, std::uint64_t>, const TraceEvent*> tasks;
  for (const TraceEvent& e : events)
    if (e.in_graph) tasks[{e.call, e.index}] = &e;
  std::uint64_t arrows = 0;
  for (const auto& [task, e] : tasks)
    for (const std::uint32_t before : e->after) {
      const auto from = tasks.find({e->call, before});
      if (from == tasks.end()) continue;  // its run ended in an error
      Json arrow{{"name", "needs"}, {"cat", "graph"}, {"pid", process}, {"id", ++arrows}};
      arrow.update({{"ph", "s"}, {"tid", from->second->worker}, {"ts", from->second->end * 1e6}});
      list.push_back(arrow);
      arrow.update({{"ph", "f"}, {"bp", "e"}, {"tid", e->worker}, {"ts", e->begin * 1e6}});
      list.push_back(std::move(arrow));
    }
}

}  // namespace

Json trace_events(const Trace& trace, int process, const std::string& name, const std::vector<std::string>& others) {
  Json events = Json::array();
  const auto entitle = [&](const char* what, int thread, const std::string& title) {
    events.push_back({{"name", what}, {"ph", "M"}, {"pid", process}, {"tid", thread}, {"args", {{"name", title}}}});
  };
  if (!name.empty()) entitle("process_name", 0, name);
  const int workers = trace.workers() - static_cast<int>(others.size());
  for (int thread = 0; thread < trace.workers(); ++thread)
    entitle("thread_name", thread,
            thread < workers ? "worker " + std::to_string(thread) : others[static_cast<std::size_t>(thread - workers)]);
  const std::vector<TraceEvent> ran = trace.events();
  for (const TraceEvent& e : ran)
    events.push_back({{"name", e.name},
                      {"ph", "X"},
                      {"pid", process},
                      {"tid", e.worker},
                      {"ts", e.begin * 1e6},
                      {"dur", (e.end - e.begin) * 1e6},
                      {"args", arguments_of(e)}});
  add_arrows(ran, process, events);
  return events;
}

void write_trace_events(const std::vector<std::string>& lists, const std::string& path) {
  AtomicFile file(path);
  const auto write = [&](std::string_view text) { file.write(std::as_bytes(std::span(text))); };
  write(R"({"displayTimeUnit":"ms","traceEvents":[)");
  for (std::size_t i = 0; i < lists.size(); ++i) {
    if (i > 0) write(",");
    write(std::string_view(lists[i]).substr(1, lists[i].size() - 2));  // without its brackets
  }
  write("]}");
  file.commit();
}

void write_trace(const Trace& trace, const std::string& path) {
  write_trace_events({trace_events(trace, 1, {}, {}).dump()}, path);
}

}  // namespace lodestone
