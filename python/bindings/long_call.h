// Work that takes long: other threads of Python run meanwhile, and Ctrl-C stops it.
//
// The work runs on a thread of its own; the calling thread looks for signals and calls the progress callback, some
// thirty times a second. A KeyboardInterrupt, or whatever the callback raises, stops the work at its next chunk or task
// and is raised once all of it has ended.
#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "parallel/scheduler/scheduler.h"
#include "python/bindings/options.h"

namespace lodestone::python {

class LongCall {
 public:
  enum class Threads { option, none };
  // Takes `progress`, called with the step and the share done in [0, 1], and `threads` (0: all of the machine) unless
  // the work uses no scheduler.
  explicit LongCall(Options& options, Threads threads = Threads::option);

  [[nodiscard]] Scheduler& scheduler() { return *cancelling_; }
  [[nodiscard]] const CancelFlag* cancel() const { return &cancel_; }
  // From any thread.
  void report(const std::string& step, double share);
  // The same, for work on one thread that goes no further when the call has been stopped: throws Cancelled.
  void report_or_stop(const std::string& step, double share);

  // The result of the work, which may not touch Python.
  template <class Work>
  auto run(const Work& work) {
    if constexpr (std::is_void_v<decltype(work())>) {
      run_free(work);
    } else {
      std::optional<decltype(work())> result;
      run_free([&] { result.emplace(work()); });
      return std::move(*result);
    }
  }

 private:
  void run_free(const std::function<void()>& work);
  // With the interpreter held: signals, then the callback with what is new.
  void tell();

  py::object progress_;
  CancelFlag cancel_{false};
  std::unique_ptr<Scheduler> scheduler_, cancelling_;
  std::mutex mutex_;
  std::optional<std::pair<std::string, double>> news_;
  std::exception_ptr failure_;  // raised by a signal or the callback
};

}  // namespace lodestone::python
