#include "experiments/metrics/schedule/recorded_work.h"

#include <algorithm>
#include <map>
#include <optional>

#include "core/base/error.h"

namespace lodestone {
namespace {

// Makes the tree of a trace: events nested in an event are calls that its body made.
class Reader {
 public:
  Reader(std::span<const TraceEvent> events, double begin, double end) {
    for (const TraceEvent& e : events)
      if (e.begin >= begin && e.end <= end) events_.push_back(&e);
    for (const TraceEvent* e : events_)
      if (e->worker != events_.front()->worker) throw InputError("a trace of several workers tells no order of work");
    std::ranges::sort(events_, [](const TraceEvent* a, const TraceEvent* b) {
      return a->begin != b->begin ? a->begin < b->begin : a->end > b->end;
    });
  }

  RecordedWork read(double begin, double end, double cpu_seconds) {
    work_.whole = task_of("", begin, end, cpu_seconds);
    if (next_ < events_.size()) throw InputError("a trace has events that overlap");
    return std::move(work_);
  }

 private:
  struct Child {
    const TraceEvent* event;
    RecordedTask task;
  };

  // The task from begin to end, whose events come next.
  RecordedTask task_of(std::string name, double begin, double end, double cpu_seconds) {
    std::vector<Child> children;
    double inside = 0;
    while (next_ < events_.size() && events_[next_]->begin < end) {
      const TraceEvent& e = *events_[next_++];
      if (e.end > end) throw InputError("a trace has events that overlap");
      children.push_back({&e, task_of(e.name, e.begin, e.end, e.cpu_seconds)});
      inside += e.cpu_seconds;
    }
    return with_gaps({std::move(name), {}}, std::move(children), begin, end, std::max(cpu_seconds - inside, 0.0));
  }

  RecordedTask with_gaps(RecordedTask task, std::vector<Child> children, double begin, double end, double own) {
    double gaps = end - begin;
    for (const Child& child : children) gaps -= child.event->end - child.event->begin;
    const double scale = gaps > 0 ? own / gaps : 0;  // of wall time between events to processor time
    double done = begin;
    for (std::size_t first = 0; first < children.size();) {
      std::size_t last = first + 1;
      while (last < children.size() && children[last].event->call == children[first].event->call) ++last;
      task.steps.push_back({scale * (children[first].event->begin - done), static_cast<int>(work_.calls.size())});
      work_.calls.push_back(call_of(std::span(children).subspan(first, last - first), scale));
      done = children[last - 1].event->end;
      first = last;
    }
    task.steps.push_back({scale * (end - done), -1});
    return task;
  }

  static RecordedCall call_of(std::span<Child> children, double scale) {
    RecordedCall call;
    double gaps = children.back().event->end - children.front().event->begin;
    std::map<std::uint64_t, std::uint32_t> number_of;  // a trace may hold tasks of a graph in any order
    for (const Child& child : children) {
      gaps -= child.event->end - child.event->begin;
      number_of.emplace(child.event->index, static_cast<std::uint32_t>(number_of.size()));
    }
    call.dispatch_seconds = scale * std::max(gaps, 0.0) / static_cast<double>(children.size());
    for (Child& child : children) {
      for (const std::uint32_t before : child.event->after) {
        const auto found = number_of.find(before);
        if (found == number_of.end()) throw InputError("a trace lacks a task that another one waited for");
        call.edges.emplace_back(found->second, static_cast<std::uint32_t>(call.tasks.size()));
      }
      call.tasks.push_back(std::move(child.task));
    }
    return call;
  }

  std::vector<const TraceEvent*> events_;
  std::size_t next_ = 0;
  RecordedWork work_;
};

using Shares = std::map<std::string, double>;  // seconds by name

// The longest chain through a task or a call, and what it consists of.
class Chains {
 public:
  explicit Chains(const RecordedWork& work) : work_(work) {}

  double work_of(const RecordedTask& task) const {
    double seconds = 0;
    for (const auto& step : task.steps) {
      seconds += step.seconds;
      if (step.call < 0) continue;
      const RecordedCall& call = work_.calls[static_cast<std::size_t>(step.call)];
      for (const RecordedTask& inner : call.tasks) seconds += work_of(inner) + call.dispatch_seconds;
    }
    return seconds;
  }

  double span_of(const RecordedTask& task) const {
    double seconds = 0;
    for (const auto& step : task.steps) {
      seconds += step.seconds;
      if (step.call >= 0) seconds += chain_of(work_.calls[static_cast<std::size_t>(step.call)], nullptr);
    }
    return seconds;
  }

  // The tasks of a call with the longest chain go to `out`, if it is given. Tasks come after those that they wait for.
  double chain_of(const RecordedCall& call, std::vector<std::uint32_t>* out) const {
    std::vector<double> ends(call.tasks.size(), 0);
    std::vector<std::optional<std::uint32_t>> from(call.tasks.size());
    std::vector<std::vector<std::uint32_t>> before(call.tasks.size());
    for (const auto& [first, then] : call.edges) before[then].push_back(first);
    std::uint32_t last = 0;
    for (std::uint32_t t = 0; t < call.tasks.size(); ++t) {
      for (const std::uint32_t b : before[t])
        if (!from[t] || ends[b] > ends[*from[t]]) from[t] = b;
      ends[t] = (from[t] ? ends[*from[t]] : 0) + span_of(call.tasks[t]) + call.dispatch_seconds;
      if (ends[t] > ends[last]) last = t;
    }
    if (out)
      for (std::optional<std::uint32_t> t = last; t; t = from[*t]) out->push_back(*t);
    return ends[last];
  }

  void add_chain(const RecordedTask& task, Shares& shares) const {
    for (const auto& step : task.steps) {
      shares[&task == &work_.whole ? name_of_step(work_, step) : task.name] += step.seconds;
      if (step.call < 0) continue;
      const RecordedCall& call = work_.calls[static_cast<std::size_t>(step.call)];
      std::vector<std::uint32_t> chain;
      (void)chain_of(call, &chain);
      for (const std::uint32_t t : chain) {
        add_chain(call.tasks[t], shares);
        shares[call.tasks[t].name] += call.dispatch_seconds;
      }
    }
  }

 private:
  const RecordedWork& work_;
};

}  // namespace

RecordedWork recorded_work(std::span<const TraceEvent> events, double begin, double end, double cpu_seconds) {
  return Reader(events, begin, end).read(begin, end, cpu_seconds);
}

std::string name_of_step(const RecordedWork& work, const RecordedTask::Step& step) {
  if (step.call < 0) return "at the end";
  return "before " + work.calls[static_cast<std::size_t>(step.call)].tasks.front().name;
}

WorkAndSpan work_and_span(const RecordedWork& work) {
  const Chains chains(work);
  WorkAndSpan out{chains.work_of(work.whole), chains.span_of(work.whole), {}};
  Shares shares;
  chains.add_chain(work.whole, shares);
  out.critical.assign(shares.begin(), shares.end());
  std::ranges::stable_sort(out.critical, [](const auto& a, const auto& b) { return a.second > b.second; });
  return out;
}

}  // namespace lodestone
