// lodestone sweep: runs what a sweep file asks for, each run in a process of its own.
#include <fmt/core.h>

#include <filesystem>

#include "core/base/error.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/sweep/directory.h"
#include "experiments/sweep/run_child.h"
#include "experiments/sweep/runner.h"

namespace lodestone {
namespace {

struct SweepOptions {
  std::string file, directory, shard;
  std::vector<std::string> only;
  int jobs = 1;
  bool resume = false, prepare = false, dry_run = false, small = false, full = false, leave_out_missing = false;
};

SweepForm form_of(const SweepOptions& options) {
  return options.small ? SweepForm::small : options.full ? SweepForm::full : SweepForm::standard;
}

// The parameters that the file sets, as "blend=step kappa0=2".
std::string setting_text(const SweepRun& run) {
  std::string text;
  for (const auto& [name, value] : run.given.items())
    text += fmt::format("{}{}={}", text.empty() ? "" : " ", name,
                        value.is_string() ? value.get<std::string>() : value.dump());
  return text;
}

std::string run_text(const SweepRun& run) {
  return fmt::format("{}  {}  {}  {}", run.sweep, run.id.empty() ? "-" : run.id, run.data.empty() ? "-" : run.data,
                     setting_text(run));
}

std::string failure_text(const Fault& fault) {
  return fault.kind + (fault.messages.empty() ? "" : ": " + fault.messages.front());
}

int ended_repetitions(const SweepRun& run, const std::filesystem::path& directory) {
  if (run.id.empty()) return 0;
  const RunFolder folder(directory, run.id);
  int count = 0;
  for (int i = 0; i < run.repetitions; ++i) count += folder.has_rows(i) ? 1 : 0;
  return count;
}

void print_notes(const SweepFile& file) {
  for (const std::string& note : file.notes) fmt::print("note: {}: {}\n", file.file, note);
}

void print_left_out(const SweepPlan& plan) {
  for (const auto& [name, path] : plan.left_out)
    fmt::print("note: {}: {} is missing, and its runs are left out; {}\n", name, path,
               remedy_for_missing(path, "put the file there"));
}

void dry_run(const SweepFile& file, const SweepOptions& options, const CommonOptions& common) {
  const auto inputs =
      find_inputs(file, data_names(file),
                  {.directory = options.directory, .make = false, .leave_out_missing = options.leave_out_missing});
  const SweepPlan plan = make_plan(file, inputs);
  std::vector<std::string> unmade;
  for (const auto& [name, input] : inputs)
    if (input.sha256.empty()) unmade.push_back(name);
  if (!unmade.empty() && !options.shard.empty())
    throw UsageError("--dry-run --shard: runs are shared out by what their data holds, and '" + unmade.front() +
                     "' has yet to be generated; leave --shard out");
  Json json = Json::array();
  const bool printed = common.prints();
  std::size_t repetitions = 0, done = 0;
  for (const SweepRun& run : options.shard.empty() ? plan.runs : runs_of(plan, parse_shard(options.shard))) {
    const int ended = ended_repetitions(run, options.directory);
    repetitions += static_cast<std::size_t>(run.repetitions);
    done += static_cast<std::size_t>(ended);
    if (printed) fmt::print("{}  {} of {} done\n", run_text(run), ended, run.repetitions);
    json.push_back({{"sweep", run.sweep},
                    {"id", run.id},
                    {"experiment", run.experiment->name},
                    {"data", run.data},
                    {"parameters", run.parameters},
                    {"repetitions", run.repetitions},
                    {"done", ended}});
  }
  if (printed) {
    print_notes(file);
    print_left_out(plan);
    fmt::print("{} runs, {} repetitions, {} done\n", json.size(), repetitions, done);
    for (const std::string& name : unmade) fmt::print("{} has yet to be generated; its runs have no id before\n", name);
  }
  write_result(common, {{"name", file.name}, {"runs", json}, {"notes", file.notes}});
}

SweepPlan prepare(const SweepFile& file, const SweepOptions& options, const CommonOptions& common) {
  Progress progress("looking at data", common.quiet);
  progress.phase("looking at data");
  InputConfig config;
  config.directory = options.directory;
  config.threads = common.threads;
  config.leave_out_missing = options.leave_out_missing;
  config.cancel = &interrupt_flag();
  std::string shown;
  config.progress = [&](const std::string& name, double share) {
    if (name != shown) progress.phase("making " + name);
    shown = name;
    progress.update(share);
  };
  return prepare_directory(file, config);
}

RunnerResult run_all(const SweepFile& file, const std::vector<SweepRun>& runs, const SweepOptions& options,
                     const CommonOptions& common) {
  Progress progress(file.name, common.quiet);
  RunnerConfig config;
  config.directory = options.directory;
  config.jobs = options.jobs;
  config.cancel = &interrupt_flag();
  RunnerCallbacks callbacks;
  callbacks.progress = [&](double share) { progress.update(share); };
  if (common.prints())
    callbacks.ended = [&](const RunEvent& event) {
      progress.clear();
      fmt::print("{}/{}  {}  repetition {}: {:.3g} s{}\n", event.done, event.all, run_text(event.run), event.repetition,
                 event.seconds, event.fault ? ", failed: " + failure_text(*event.fault) : "");
      std::fflush(stdout);
    };
  return run_missing(runs, config, callbacks);
}

Json summary(const SweepFile& file, const std::vector<SweepRun>& runs, const RunnerResult& result,
             const SweepOptions& options) {
  Json failures = Json::array();
  for (const RunnerFailure& failure : result.failures)
    failures.push_back({{"id", failure.id},
                        {"repetition", failure.repetition},
                        {"kind", failure.fault.kind},
                        {"messages", failure.fault.messages}});
  return {{"name", file.name},         {"directory", options.directory}, {"runs", runs.size()},
          {"repetitions", result.all}, {"before", result.before},        {"ran", result.ran},
          {"failures", failures}};
}

void run(const SweepOptions& options, const CommonOptions& common) {
  check_files(common, {{"FILE", options.file}});
  const Shard shard = options.shard.empty() ? Shard{} : parse_shard(options.shard);
  SweepFile file = load_sweep_file(options.file, form_of(options));
  if (!options.only.empty()) keep_sweeps(file, options.only);
  check_directory(options.directory, file.name, options.resume || options.dry_run);
  if (options.dry_run) return dry_run(file, options, common);
  set_interrupt_line("lodestone: interrupted; finished runs were kept, --resume continues\n");
  const bool printed = common.prints();
  if (printed) print_notes(file);
  if (printed && options.jobs > 1)
    fmt::print("note: {} runs at a time share the machine; their times are not comparable\n", options.jobs);
  const SweepPlan plan = prepare(file, options, common);
  if (printed) print_left_out(plan);
  const std::vector<SweepRun> runs = runs_of(plan, shard);
  if (options.prepare) return write_result(common, {{"name", file.name}, {"runs", runs.size()}});
  const RunnerResult result = run_all(file, runs, options, common);
  write_result(common, summary(file, runs, result, options));
  if (printed)
    fmt::print("{}: {} runs, {} repetitions: {} were done before, {} ran, {} failed\n", options.directory, runs.size(),
               result.all, result.before, result.ran, result.failures.size());
  if (result.failures.empty()) return;
  const RunnerFailure& first = result.failures.front();
  throw NegativeResult(fmt::format("{} of {} repetitions failed, the first one, {}/runs/{}, repetition {}, with {}",
                                   result.failures.size(), result.all, options.directory, first.id, first.repetition,
                                   failure_text(first.fault)));
}

// One repetition, for a sweep that started this process.
struct ChildOptions {
  std::string folder;
  int report = -1;
};

OptionTable declare(SweepOptions& o) {
  return {
      OptionSpec{"FILE", &o.file, "The sweep file (.toml)"}.must(),
      OptionSpec{"-o,--output", &o.directory, "Folder of the sweep; made if it is not there"}.must(),
      OptionSpec{"--jobs", &o.jobs,
                 "Number of runs at a time, as far as there are processors for them; times are comparable with 1 only"}
          .between(1, 1024),
      {"--only", &o.only, "Run this sweep of the file alone; may be repeated"},
      {"--shard", &o.shard, "Part i of n of the runs, as 2/8"},
      {"--resume", &o.resume, "Run what is missing, has changed, or ended without rows"},
      {"--dry-run", &o.dry_run, "Print the runs and how many of their repetitions are done; change nothing"},
      OptionSpec{"--prepare", &o.prepare, "Make the data and list the runs in sweep.json, and run none"}.not_with(
          {"--dry-run"}),
      {"--small", &o.small, "Apply the overrides that the file has under 'small'"},
      OptionSpec{"--full", &o.full, "Apply the overrides that the file has under 'full'"}.not_with({"--small"}),
      {"--leave-out-missing", &o.leave_out_missing,
       "Leave out the data whose files are missing, with a note; without it they are an error"}};
}

}  // namespace

void add_sweep(CommandTable& commands) {
  define_command<SweepOptions>(
      commands,
      {"sweep", "Run an experiment over parameters and data; status 1 when a run failed",
       "  lodestone sweep experiments/studies/standard/ablation.toml -o ablation --dry-run\n"
       "  lodestone sweep experiments/studies/standard/ablation.toml -o ablation --small\n"
       "  lodestone sweep experiments/studies/standard/ablation.toml -o ablation --resume --shard 2/8\n"
       "  lodestone sweep experiments/studies/standard/scaling.toml -o scaling --only schedule\n",
       "Threads that make data; those of a run are a parameter of its experiment"},
      declare, run);
  const auto child = std::make_shared<ChildOptions>();
  commands.push_back({{"sweep-run", "", ""},
                      {OptionSpec{"FOLDER", &child->folder}.must(), OptionSpec{"--report", &child->report}.must()},
                      [child] { run_child(child->folder, child->report, interrupt_flag()); },
                      true});
}

}  // namespace lodestone
