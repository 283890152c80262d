#include "experiments/mpi/rank_trace.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "experiments/command_line/trace_file.h"

namespace lodestone {
namespace {

constexpr double shortest_wait = 20e-6;  // seconds, that is recorded

}  // namespace

RankTrace::RankTrace(std::string path, Ranks& ranks, std::unique_ptr<Scheduler>& scheduler)
    : path_(std::move(path)), ranks_(ranks) {
  if (path_.empty()) return;
  workers_ = scheduler->workers();
  (void)ranks.any(true);
  trace_ = std::make_shared<Trace>(workers_ + 2);
  scheduler = make_tracing_scheduler(std::move(scheduler), trace_);
  ranks.watch([this](double seconds, int from) {
    const double end = trace_->now();
    if (seconds < shortest_wait) return;
    trace_->record({.name = "wait",
                    .index = static_cast<std::uint64_t>(from),
                    .worker = workers_ + 1,
                    .begin = std::max(end - seconds, 0.0),
                    .end = end});
  });
}

void RankTrace::begin_stage(const std::string& name) {
  if (!trace_) return;
  end_stage();
  stage_ = name, stage_begin_ = trace_->now();
}

void RankTrace::end_stage() {
  if (stage_.empty()) return;
  trace_->record({.name = stage_, .worker = workers_, .begin = stage_begin_, .end = trace_->now()});
  stage_.clear();
}

void RankTrace::gather() {
  if (!trace_) return;
  end_stage();
  const std::string name = "rank " + std::to_string(ranks_.rank()) + " on " + ranks_.host();
  const std::string text = trace_events(*trace_, ranks_.rank(), name, {"stages", "messages"}).dump();
  std::vector<std::vector<char>> out(static_cast<std::size_t>(ranks_.count()));
  out.front().assign(text.begin(), text.end());
  events_ = ranks_.exchange(out);
}

void RankTrace::write() const {
  if (!trace_) return;
  Json events = Json::array();
  for (const std::vector<char>& of_rank : events_)
    for (const Json& event : Json::parse(std::string_view(of_rank.data(), of_rank.size()))) events.push_back(event);
  write_trace_events(std::move(events), path_);
}

}  // namespace lodestone
