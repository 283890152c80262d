// Runs what is missing of a sweep: every repetition in a process of its own, in rounds (repetition 0 of all runs, then
// 1 of all), together with whatever other processes work in the same directory.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/sweep/plan.h"
#include "experiments/sweep/run_folder.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct RunnerConfig {
  std::filesystem::path directory;
  int jobs = 1;  // at once; times of runs that share a machine are not comparable
  // A run is pinned to as many processors as its parameter `threads` says, 0: to all, which it has for itself. It waits
  // for those of the other jobs; where another process has them, it is not pinned.
  const CancelFlag* cancel = nullptr;
};

// A repetition that has ended.
struct RunEvent {
  const SweepRun& run;
  int repetition;
  double seconds;
  std::optional<Fault> fault;
  std::size_t done, all;  // repetitions, this one included
};

struct RunnerCallbacks {
  std::function<void(const RunEvent&)> ended = [](const RunEvent&) {};
  // Share of the whole, estimated from how long the repetitions so far took.
  std::function<void(double)> progress = [](double) {};
};

struct RunnerFailure {
  std::string id;
  int repetition;
  Fault fault;
};

struct RunnerResult {
  std::size_t all = 0;                  // repetitions
  std::size_t before = 0;               // done when it began
  std::size_t ran = 0;                  // by this process
  std::vector<RunnerFailure> failures;  // of all repetitions, also of those that were done before
};

// Failed runs do not end it. Repetitions that failed without rows before it began are tried again, once. Throws
// Cancelled when the flag is set: children are ended, finished rows stay, nothing half-done does. Throws FileError when
// results cannot be written.
[[nodiscard]] RunnerResult run_missing(const std::vector<SweepRun>& runs, const RunnerConfig& config,
                                       const RunnerCallbacks& callbacks);

}  // namespace lodestone
