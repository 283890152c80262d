#include "python/bindings/long_call.h"

#include <chrono>
#include <semaphore>

#include "experiments/command_line/exit_status.h"
#include "parallel/scheduler/background_job.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone::python {
namespace {

constexpr std::chrono::milliseconds pause_between_looks{30};

}  // namespace

LongCall::LongCall(Options& options, Threads threads) : progress_(py::none()) {
  options.take("progress", progress_);
  if (threads == Threads::none) return;
  int count = 0;
  options.take("threads", count);
  if (count < 0) throw UsageError("threads: " + std::to_string(count) + " is less than 0");
  scheduler_ = make_tbb_scheduler(count);
  cancelling_ = make_watched_scheduler(*scheduler_, {.cancel = &cancel_});
}

void LongCall::report(const std::string& step, double share) {
  const std::lock_guard lock(mutex_);
  news_ = {step, share};
}

void LongCall::report_or_stop(const std::string& step, double share) {
  if (cancel_) throw Cancelled{};
  report(step, share);
}

void LongCall::tell() {
  const py::gil_scoped_acquire held;
  if (failure_) return;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    std::optional<std::pair<std::string, double>> news;
    {
      const std::lock_guard lock(mutex_);
      news.swap(news_);
    }
    if (news && !progress_.is_none()) progress_(news->first, news->second);
  } catch (...) {
    failure_ = std::current_exception();
    cancel_ = true;
  }
}

void LongCall::run_free(const std::function<void()>& work) {
  {
    const py::gil_scoped_release free;
    std::binary_semaphore ended{0};
    BackgroundJob job(work, [&] { ended.release(); });
    while (!ended.try_acquire_for(pause_between_looks)) tell();
    try {
      job.finish();
    } catch (const Cancelled&) {
      if (!failure_) throw;
    }
    tell();
  }
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

}  // namespace lodestone::python
