#include "experiments/sweep/runner.h"

#include <fmt/core.h>
#include <poll.h>

#include <algorithm>
#include <csignal>
#include <ctime>
#include <list>
#include <memory>

#include "core/base/error.h"
#include "experiments/command_line/child_process.h"
#include "experiments/sweep/manifest.h"
#include "experiments/sweep/processor_claim.h"
#include "experiments/sweep/time_left.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/processors.h"

namespace lodestone {
namespace {

constexpr int tick_milliseconds = 100;  // between looks at locks of others, and at the flag
constexpr double patience_seconds = 5;  // with children that were told to end

struct Task {
  std::size_t run;
  int repetition;
  std::string old_fault;  // mark of a fault that there was before, which is tried again
};

// A repetition under way. The lock ends with the child, or when its results have been taken over.
struct Job {
  Task task;
  FileLock lock;
  ProcessorClaim claim;
  std::time_t started;
  Stopwatch clock;
  std::unique_ptr<ChildProcess> child;

  [[nodiscard]] bool is_pinned() const { return !claim.processors().empty(); }
};

// The time that a repetition took.
struct Spent {
  std::time_t started = 0;
  double seconds = 0, cpu_seconds = 0;  // wall, and of all its threads
  bool pinned = false;
};

// The last line that the child has written, where it may have said why it ended.
std::string last_words(const std::filesystem::path& log) {
  std::string text = read_if_there(log);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  text.erase(0, text.find_last_of('\n') + 1);
  return text.starts_with("---") ? "" : text;
}

// The fault to record of a child that left no verdict of its own.
std::optional<Fault> crash_of(const ChildEnd& end, const std::filesystem::path& log) {
  if (end.succeeded()) return {};
  const std::string words = last_words(log);
  constexpr std::string_view own = "lodestone: ";  // begins the one line of an error: results could not be written
  if (end.failed() && words.starts_with(own)) return Fault{"error", {words.substr(own.size())}};
  Fault crash{"crash", {end.reason()}};
  if (!words.empty()) crash.messages.push_back(words);
  return crash;
}

// Rows are recorded under the hash that the input had when the sweep began. What is there now may be something else.
std::optional<Fault> change_of(const SweepInput& input) {
  const std::optional<std::string> changed = changed_file(input);
  if (!changed) return {};
  return Fault{"error", {*changed + " changed since the sweep began; run again with --resume"}};
}

class Runner {
 public:
  Runner(const std::vector<SweepRun>& runs, const RunnerConfig& config, const RunnerCallbacks& callbacks)
      : runs_(runs), config_(config), callbacks_(callbacks), allowed_(one_per_core_first(allowed_processors())) {
    for (const SweepRun& run : runs) folders_.emplace_back(config.directory, run.id).tidy();
    list_tasks();
  }

  RunnerResult run() {
    try {
      while (true) {
        check_cancel();
        while (static_cast<int>(jobs_.size()) < config_.jobs && start_next()) {
        }
        if (jobs_.empty() && pending_.empty()) break;
        wait();
        check_cancel();
        collect();
        tell_progress();
      }
    } catch (...) {
      abandon();
      throw;
    }
    find_failures();
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool ended(const Task& task) const {
    const RunFolder& folder = folders_[task.run];
    if (folder.has_rows(task.repetition)) return true;
    const std::string mark = folder.fault_mark(task.repetition);
    return !mark.empty() && mark != task.old_fault;
  }

  void check_cancel() const {
    if (config_.cancel && *config_.cancel) throw Cancelled{};
  }

  // In rounds.
  void list_tasks() {
    int rounds = 0;
    for (const SweepRun& run : runs_) rounds = std::max(rounds, run.repetitions);
    for (int repetition = 0; repetition < rounds; ++repetition)
      for (std::size_t run = 0; run < runs_.size(); ++run) {
        if (repetition >= runs_[run].repetitions) continue;
        ++result_.all;
        const Task task{run, repetition, folders_[run].fault_mark(repetition)};
        if (folders_[run].has_rows(repetition)) {
          ++result_.before;
          time_left_.ended(run, folders_[run].seconds(repetition), false);
        } else {
          pending_.push_back(task);
          time_left_.expected(run);
        }
      }
  }

  // The first task that nobody works on; false when there is none at the moment, or when it has to wait for processors
  // that jobs of this process have. Those of other processes may be had for hours.
  bool start_next() {
    for (auto task = pending_.begin(); task != pending_.end();) {
      if (ended(*task)) {  // by another process
        time_left_.ended(task->run, folders_[task->run].seconds(task->repetition), true);
        task = pending_.erase(task);
        continue;
      }
      FileLock lock = folders_[task->run].try_lock();
      if (lock.held() && !ended(*task)) {
        ProcessorClaim claim(runs_[task->run].parameters.value("threads", 0), allowed_);
        if (claim.processors().empty() && std::ranges::any_of(jobs_, &Job::is_pinned)) return false;
        start(*task, std::move(lock), std::move(claim));
        pending_.erase(task);
        return true;
      }
      ++task;
    }
    return false;
  }

  void start(const Task& task, FileLock lock, ProcessorClaim claim) {
    const RunFolder& folder = folders_[task.run];
    folder.clear();
    try {
      folder.describe_run(runs_[task.run]);
      if (const std::optional<Fault> change = change_of(runs_[task.run].input))
        refuse(task, *change);
      else
        launch(task, std::move(lock), std::move(claim));
    } catch (...) {
      folder.clear();
      throw;
    }
  }

  void launch(const Task& task, FileLock lock, ProcessorClaim claim) {
    const SweepRun& run = runs_[task.run];
    const RunFolder& folder = folders_[task.run];
    const WorkFolder work = folder.begin(task.repetition);
    write_aside(work.job(), Json{{"experiment", run.experiment->name},
                                 {"program", run.program},
                                 {"parameters", with_copies(run.parameters, run.files, config_.directory)},
                                 {"input", run.input.path},
                                 {"repetition", task.repetition},
                                 {"processors", claim.processors()}}
                                .dump());
    const std::time_t now = std::time(nullptr);
    append_to_log(folder, fmt::format("--- repetition {}, {}\n", task.repetition, utc(now)));
    auto child = std::make_unique<ChildProcess>(ChildCommand{{"sweep-run", work.path.string()}}, folder.log(),
                                                lock.descriptor());
    jobs_.push_back({task, std::move(lock), std::move(claim), now, {}, std::move(child)});
  }

  // Ends a repetition that was not started.
  void refuse(const Task& task, const Fault& fault) {
    const RunFolder& folder = folders_[task.run];
    (void)folder.begin(task.repetition);
    append_to_log(folder, fmt::format("--- repetition {}: {}\n", task.repetition, fault.messages.front()));
    record(task, {std::time(nullptr)}, fault);
  }

  static void append_to_log(const RunFolder& folder, const std::string& line) {
    std::FILE* log = std::fopen(folder.log().c_str(), "a");
    const bool written = log && std::fputs(line.c_str(), log) >= 0;
    if (!log || std::fclose(log) != 0 || !written)
      throw FileError(
          describe(folder.log().string(), "", "cannot be written", "free some space or choose another disk"));
  }

  // Until a child reports or ends, or for a tick. A signal ends the waiting, too.
  void wait() {
    std::vector<pollfd> reports;
    for (const Job& job : jobs_) reports.push_back({job.child->report(), POLLIN, 0});
    poll(reports.data(), reports.size(), tick_milliseconds);
  }

  void collect() {
    for (auto job = jobs_.begin(); job != jobs_.end();) {
      const std::optional<ChildEnd> end = job->child->poll_end();
      if (!end) {
        ++job;
        continue;
      }
      take_over(*job, *end);
      job = jobs_.erase(job);
    }
  }

  // A child that was told to end as this process was has no fault; it may have heard of it first.
  void take_over(const Job& job, const ChildEnd& end) {
    if (end.interrupted()) poll(nullptr, 0, tick_milliseconds);  // which a signal ends
    if (!end.succeeded()) check_cancel();
    std::optional<Fault> fault = change_of(runs_[job.task.run].input);
    if (!fault) fault = crash_of(end, folders_[job.task.run].log());
    record(job.task, {job.started, job.clock.seconds(), end.cpu_seconds, job.is_pinned()}, std::move(fault));
  }

  // `fault` is known here; what the child found is in its work folder. The task is pending or a job no more afterwards.
  void record(const Task& task, const Spent& spent, std::optional<Fault> fault) {
    const SweepRun& run = runs_[task.run];
    const Json facts = {{"experiment", run.experiment->name},
                        {"repetition", task.repetition},
                        {"start", utc(spent.started)},
                        {"end", utc(std::time(nullptr))},
                        {"wall_seconds", spent.seconds},
                        {"cpu_seconds", spent.cpu_seconds},
                        {"jobs", config_.jobs},
                        {"pinned", spent.pinned}};
    fault = folders_[task.run].take_over(task.repetition, facts, std::move(fault));
    ++result_.ran;
    time_left_.ended(task.run, spent.seconds, true);
    callbacks_.ended(
        {run, task.repetition, spent.seconds, fault, result_.all - pending_.size() - jobs_.size() + 1, result_.all});
  }

  void tell_progress() {
    double seconds = 0, shares = 0;
    for (Job& job : jobs_) {
      const double share = job.child->share(), elapsed = job.clock.seconds();
      const double expected = time_left_.of(job.task.run);
      seconds += share > 0 ? share * expected : std::min(elapsed, expected);
      shares += share;
    }
    // A run that takes longer than expected makes the rest longer, too; the bar does not go back.
    share_ = std::max(share_, time_left_.share(seconds, shares));
    callbacks_.progress(share_);
  }

  // Children are asked to end, as they may have scratch files elsewhere, and then made to.
  void abandon() {
    for (const Job& job : jobs_) job.child->signal(SIGTERM);
    const Stopwatch waited;
    while (!jobs_.empty() && waited.seconds() < patience_seconds) {
      std::erase_if(jobs_, [&](Job& job) { return job.child->poll_end() && (folders_[job.task.run].clear(), true); });
      poll(nullptr, 0, 10);
    }
    for (Job& job : jobs_) {
      job.child.reset();
      folders_[job.task.run].clear();
    }
  }

  void find_failures() {
    for (std::size_t i = 0; i < runs_.size(); ++i)
      for (int repetition = 0; repetition < runs_[i].repetitions; ++repetition)
        if (const auto fault = folders_[i].fault(repetition))
          result_.failures.push_back({runs_[i].id, repetition, *fault});
  }

  const std::vector<SweepRun>& runs_;
  const RunnerConfig& config_;
  const RunnerCallbacks& callbacks_;
  std::vector<int> allowed_;
  std::vector<RunFolder> folders_;
  std::list<Task> pending_;
  std::list<Job> jobs_;
  TimeLeft time_left_;
  double share_ = 0;  // done, as it was told
  RunnerResult result_;
};

}  // namespace

RunnerResult run_missing(const std::vector<SweepRun>& runs, const RunnerConfig& config,
                         const RunnerCallbacks& callbacks) {
  return Runner(runs, config, callbacks).run();
}

}  // namespace lodestone
