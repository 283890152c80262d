#include "parallel/scheduler/background_job.h"

#include <utility>

namespace lodestone {

BackgroundJob::BackgroundJob(std::function<void()> work, std::function<void()> on_end)
    : thread_([this, work = std::move(work), on_end = std::move(on_end)] {
        try {
          work();
        } catch (...) {
          failure_ = std::current_exception();
        }
        ended_ = true;
        if (on_end) on_end();
      }) {}

BackgroundJob::~BackgroundJob() {
  if (thread_.joinable()) thread_.join();
}

void BackgroundJob::finish() {
  if (thread_.joinable()) thread_.join();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

}  // namespace lodestone
