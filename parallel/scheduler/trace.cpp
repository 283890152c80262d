#include "parallel/scheduler/trace.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

namespace lodestone {
namespace {

class TracingScheduler final : public Scheduler {
 public:
  TracingScheduler(std::unique_ptr<Scheduler> inner, std::shared_ptr<Trace> trace)
      : inner_(std::move(inner)), trace_(std::move(trace)) {}

  [[nodiscard]] int workers() const override { return inner_->workers(); }
  [[nodiscard]] int worker_index() const override { return inner_->worker_index(); }
  void name_work(std::string_view name) override { name_ = name; }

  void for_chunks(std::size_t count, std::size_t grain, const std::function<void(ChunkRange)>& body) override {
    const std::uint32_t call = ++calls_;
    inner_->for_chunks(count, grain, [&, call](ChunkRange range) {
      TraceEvent event{.name = name_, .index = range.index, .worker = worker_index(), .call = call};
      time(event, [&] { body(range); });
    });
  }

  void run_graph(const TaskGraph& graph, const std::function<void(std::uint32_t)>& body,
                 const CancelFlag* cancel) override {
    const std::uint32_t call = ++calls_;
    std::vector<std::vector<std::uint32_t>> after(graph.task_count);
    for (const auto& [before, task] : graph.edges) after[task].push_back(before);
    inner_->run_graph(
        graph,
        [&](std::uint32_t task) {
          TraceEvent event{.name = graph.label ? graph.label(task) : name_, .index = task, .worker = worker_index()};
          event.call = call, event.in_graph = true, event.after = std::move(after[task]);
          std::ranges::sort(event.after);
          if (graph.place) event.place = graph.place(task);
          time(event, [&] { body(task); });
        },
        cancel);
  }

 private:
  template <class Work>
  void time(TraceEvent& event, const Work& work) {
    const double cpu = thread_cpu_seconds();
    event.begin = trace_->now();
    work();
    event.end = trace_->now();
    event.cpu_seconds = thread_cpu_seconds() - cpu;
    trace_->record(std::move(event));
  }

  std::unique_ptr<Scheduler> inner_;
  std::shared_ptr<Trace> trace_;
  std::string name_;
  std::atomic<std::uint32_t> calls_ = 0;  // bodies make calls, too
};

// Seconds covered by at least one of a worker's events, which are ordered by their ends: inner ones before outer ones.
double covered(const std::vector<TraceEvent>& events, double from) {
  double sum = 0, begin = 0;
  bool any = false;
  for (std::size_t i = events.size(); i-- > 0;) {
    const TraceEvent& e = events[i];
    if (e.begin < from || (any && e.begin >= begin)) continue;  // nested in a later one
    sum += e.end - e.begin;
    begin = e.begin;
    any = true;
  }
  return sum;
}

}  // namespace

Trace::Trace(int workers) : by_worker_(static_cast<std::size_t>(workers)) {}

void Trace::record(TraceEvent event) { by_worker_[static_cast<std::size_t>(event.worker)].push_back(std::move(event)); }

std::vector<TraceEvent> Trace::events() const {
  std::vector<TraceEvent> all;
  for (const auto& events : by_worker_) all.insert(all.end(), events.begin(), events.end());
  return all;
}

TraceSummary summarize(const Trace& trace, double from, double until) {
  std::vector<std::vector<TraceEvent>> by_worker(static_cast<std::size_t>(trace.workers()));
  double first = std::numeric_limits<double>::max(), last = from;
  for (TraceEvent& e : trace.events()) {
    if (e.begin < from || e.begin >= until) continue;
    first = std::min(first, e.begin);
    last = std::max(last, e.end);
    by_worker[static_cast<std::size_t>(e.worker)].push_back(std::move(e));
  }
  TraceSummary summary;
  if (last <= first) return summary;
  summary.seconds = last - first;
  double busy = 0, earliest_end = last;
  for (const auto& events : by_worker) {
    busy += covered(events, from);
    earliest_end = std::min(earliest_end, events.empty() ? first : events.back().end);
  }
  summary.busy = busy / (summary.seconds * static_cast<double>(by_worker.size()));
  summary.idle_tail = last - earliest_end;
  return summary;
}

std::unique_ptr<Scheduler> make_tracing_scheduler(std::unique_ptr<Scheduler> inner, std::shared_ptr<Trace> trace) {
  return std::make_unique<TracingScheduler>(std::move(inner), std::move(trace));
}

}  // namespace lodestone
