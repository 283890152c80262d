// One piece of work on a thread of its own, for programs that have to go on meanwhile: a window that answers.
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <thread>

namespace lodestone {

class BackgroundJob {
 public:
  // Starts at once. `on_end` is called on the job's thread when `work` has returned or thrown; it must not throw.
  explicit BackgroundJob(std::function<void()> work, std::function<void()> on_end = {});
  ~BackgroundJob();  // waits for the end
  BackgroundJob(const BackgroundJob&) = delete;
  BackgroundJob& operator=(const BackgroundJob&) = delete;

  [[nodiscard]] bool ended() const { return ended_; }
  // Waits for the end. Rethrows what the work has thrown, Cancelled among it; once.
  void finish();

 private:
  std::atomic<bool> ended_{false};
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace lodestone
