#include "experiments/mpi/rank_trace.h"

#include <algorithm>
#include <utility>

#include "experiments/command_line/trace_file.h"

namespace lodestone {
namespace {

constexpr double shortest_wait = 20e-6;                    // seconds, that is recorded
constexpr std::size_t piece_bytes = std::size_t{1} << 18;  // of a rank's events in a round

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
  events_.resize(static_cast<std::size_t>(ranks_.count()));
  for (std::size_t sent = 0; ranks_.any(sent < text.size()); sent += piece_bytes) {
    std::vector<std::vector<char>> out(events_.size());
    if (sent < text.size())
      out.front().assign(text.begin() + static_cast<std::ptrdiff_t>(sent),
                         text.begin() + static_cast<std::ptrdiff_t>(std::min(sent + piece_bytes, text.size())));
    const std::vector<std::vector<char>> came = ranks_.exchange(out);
    for (std::size_t rank = 0; rank < came.size(); ++rank) events_[rank].append(came[rank].begin(), came[rank].end());
  }
}

void RankTrace::write() const {
  if (!trace_) return;
  write_trace_events(events_, path_);
}

}  // namespace lodestone
