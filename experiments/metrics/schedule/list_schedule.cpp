#include "experiments/metrics/schedule/list_schedule.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <queue>
#include <set>

#include "core/base/error.h"

namespace lodestone {
namespace {

// A task that a worker is in the midst of. A worker has several: those further down wait for calls that they made.
struct Frame {
  const RecordedTask* task = nullptr;
  int call = -1;  // that the task is part of; -1: the whole program
  std::uint32_t number = 0;
  std::size_t step = 0;
};

struct Worker {
  std::vector<Frame> frames;
};

struct OpenCall {
  std::vector<std::uint32_t> missing;             // by task: tasks it still waits for
  std::vector<std::vector<std::uint32_t>> after;  // by task: those that wait for it
  std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, std::greater<>> ready;
  std::size_t unfinished = 0;
  std::size_t owner = 0;  // the worker that made the call
  bool owner_waits = false;
  std::size_t order = 0;  // of its begin among all
};

// A stretch of the whole program, to say during which ones workers are idle.
struct Stage {
  std::string name;
  double begin = 0, busy = 0;  // seconds of workers
};

class Simulation {
 public:
  Simulation(const RecordedWork& work, const VirtualWorkers& workers)
      : work_(work), slowdown_(workers.slowdown), workers_(static_cast<std::size_t>(workers.count)) {
    calls_.resize(work.calls.size());
    for (std::size_t w = workers_.size(); w-- > 1;) idle_.push_back(w);
  }

  Schedule run() {
    workers_[0].frames.push_back({&work_.whole});
    begin_stage(name_of_step(work_, work_.whole.steps.front()));
    spend(0, work_.whole.steps.front().seconds);
    while (!ends_.empty()) {
      const auto [time, order, worker] = ends_.top();
      ends_.pop();
      now_ = time;
      end_step(worker);
      hand_out();
    }
    end_stage();
    Schedule schedule{now_, {idle_by_stage_.begin(), idle_by_stage_.end()}};
    std::ranges::stable_sort(schedule.idle, [](const auto& a, const auto& b) { return a.second > b.second; });
    return schedule;
  }

 private:
  struct End {
    double time;
    std::size_t order, worker;
    bool operator>(const End& other) const { return time != other.time ? time > other.time : order > other.order; }
  };

  void spend(std::size_t worker, double seconds) {
    stage_.busy += seconds;
    ends_.push({now_ + seconds, spent_++, worker});
  }

  void begin_stage(std::string name) { stage_ = {std::move(name), now_, 0}; }
  void end_stage() {
    const double idle = static_cast<double>(workers_.size()) * (now_ - stage_.begin) - stage_.busy;
    idle_by_stage_[stage_.name] += std::max(idle, 0.0);
  }

  // A worker has spent the seconds of a step: the call that follows begins, or its task ends.
  void end_step(std::size_t worker) {
    const Frame& frame = workers_[worker].frames.back();
    const int call = frame.task->steps[frame.step].call;
    if (call >= 0) return begin_call(call, worker);
    if (frame.call < 0) return;  // the whole program
    end_task(worker);
  }

  void begin_call(int number, std::size_t worker) {
    const RecordedCall& call = work_.calls[static_cast<std::size_t>(number)];
    OpenCall& open = calls_[static_cast<std::size_t>(number)];
    open.missing.assign(call.tasks.size(), 0), open.after.resize(call.tasks.size());
    for (const auto& [before, then] : call.edges) ++open.missing[then], open.after[before].push_back(then);
    for (std::uint32_t t = 0; t < call.tasks.size(); ++t)
      if (open.missing[t] == 0) open.ready.push(t);
    open.unfinished = call.tasks.size(), open.owner = worker, open.owner_waits = true, open.order = begun_++;
    with_ready_.emplace(open.order, number);
    if (workers_[worker].frames.size() == 1 && worker == 0) end_stage(), begin_stage(call.tasks.front().name);
  }

  void end_task(std::size_t worker) {
    const Frame frame = workers_[worker].frames.back();
    workers_[worker].frames.pop_back();
    OpenCall& open = calls_[static_cast<std::size_t>(frame.call)];
    for (const std::uint32_t then : open.after[frame.number])
      if (--open.missing[then] == 0) {
        open.ready.push(then);
        with_ready_.emplace(open.order, frame.call);
      }
    --open.unfinished;
    if (worker == open.owner)
      open.owner_waits = true;  // for the rest of its call
    else
      idle_.push_back(worker);
    if (open.unfinished == 0) go_on(open.owner);
  }

  // All tasks of the call that a worker waits for have ended.
  void go_on(std::size_t worker) {
    Frame& frame = workers_[worker].frames.back();
    calls_[static_cast<std::size_t>(frame.task->steps[frame.step].call)].owner_waits = false;
    const RecordedTask::Step& step = frame.task->steps[++frame.step];
    const bool whole = frame.call < 0;
    if (whole) end_stage(), begin_stage(name_of_step(work_, step));
    spend(worker, whole ? step.seconds : step.seconds * slowdown_);
  }

  // Every task that is ready goes to a worker that may take it, as long as there are both.
  void hand_out() {
    for (auto at = with_ready_.begin(); at != with_ready_.end();) {
      OpenCall& open = calls_[static_cast<std::size_t>(at->second)];
      while (!open.ready.empty() && (open.owner_waits || !idle_.empty())) {
        std::size_t worker = open.owner;
        if (open.owner_waits)
          open.owner_waits = false;
        else
          worker = idle_.back(), idle_.pop_back();
        begin_task(worker, at->second, open);
      }
      at = open.ready.empty() ? with_ready_.erase(at) : std::next(at);
    }
  }

  void begin_task(std::size_t worker, int number, OpenCall& open) {
    const RecordedCall& call = work_.calls[static_cast<std::size_t>(number)];
    const std::uint32_t t = open.ready.top();
    open.ready.pop();
    workers_[worker].frames.push_back({&call.tasks[t], number, t, 0});
    spend(worker, call.dispatch_seconds + call.tasks[t].steps.front().seconds * slowdown_);
  }

  const RecordedWork& work_;
  double slowdown_;
  std::vector<Worker> workers_;
  std::vector<OpenCall> calls_;
  std::vector<std::size_t> idle_;                     // workers without a frame
  std::set<std::pair<std::size_t, int>> with_ready_;  // calls with tasks that are ready, by the order of their begins
  std::priority_queue<End, std::vector<End>, std::greater<>> ends_;
  double now_ = 0;
  std::size_t spent_ = 0, begun_ = 0;
  Stage stage_;
  std::map<std::string, double> idle_by_stage_;
};

}  // namespace

Schedule list_schedule(const RecordedWork& work, const VirtualWorkers& workers) {
  if (workers.count < 1) throw InputError("a schedule needs a worker");
  if (!(workers.slowdown >= 1)) throw InputError("a slowdown is at least 1");
  return Simulation(work, workers).run();
}

}  // namespace lodestone
