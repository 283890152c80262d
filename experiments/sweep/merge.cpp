#include "experiments/sweep/merge.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/files/text_file.h"
#include "experiments/sweep/directory.h"
#include "experiments/sweep/files.h"
#include "experiments/sweep/run_folder.h"
#include "experiments/sweep/sheet.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

// The sheet that all folders have.
SweepSheet common_sheet(const SweepMergeConfig& config) {
  std::optional<SweepSheet> common;
  for (const std::string& folder : config.from) {
    std::optional<SweepSheet> sheet = read_sheet(folder);
    if (!sheet)
      throw InputError(describe(folder, "", "holds no sweep", "name folders that lodestone sweep has written"));
    if (common && sheet->content != common->content)
      throw InputError(describe(folder, "", "is not the same sweep as " + config.from.front(),
                                "merge what the same program has made of the same file and data"));
    if (!common) common = std::move(sheet);
  }
  check_directory(config.to, common->name, true);
  if (const auto there = read_sheet(config.to); there && there->content != common->content)
    throw InputError(describe(config.to.string(), "", "holds another sweep", "choose another folder"));
  return *std::move(common);
}

// The results that a repetition has.
struct Outcome {
  bool rows = false, fault = false;
};

Outcome outcome_of(const RunFolder& run, int repetition) {
  return {run.has_rows(repetition), run.fault(repetition).has_value()};
}

// Rows are worth more than an error, and anything more than nothing; what is there is kept.
bool is_wanted(const Outcome& offered, const Outcome& there) {
  return !there.rows && (offered.rows || (offered.fault && !there.fault));
}

void copy_text(const fs::path& from, const fs::path& to) { write_durably(to, read_text(from)); }

// Files that parameters name: each by its content, so that one that is there is the same.
void take_files(const Json& sweep, const fs::path& from, const fs::path& to) {
  const Json* const files = sweep.find("files");
  if (!files) return;
  for (const auto& [name, file] : files->items()) {
    const fs::path copy = file.at("path").get<std::string>();
    make_folder((to / copy).parent_path());
    if (!fs::exists(to / copy)) copy_text(from / copy, to / copy);
  }
}

// Copies files that belong to the run and not to a repetition, where `to` has none.
void take_run(const RunFolder& from, const RunFolder& to) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(from.path(), ignored)) {
    const fs::path name = entry.path().filename();
    const bool wanted = name == "parameters.json" || name == "log.txt" || is_picture(name);
    if (wanted && !fs::exists(to.path() / name)) copy_text(entry.path(), to.path() / name);
  }
}

// In the order of RunFolder::take_over().
void take_repetition(const RunFolder& from, const RunFolder& to, int repetition) {
  const Outcome outcome = outcome_of(from, repetition);
  copy_text(from.manifest_file(repetition), to.manifest_file(repetition));
  if (outcome.fault)
    copy_text(from.fault_file(repetition), to.fault_file(repetition));
  else
    fs::remove(to.fault_file(repetition));
  if (outcome.rows) copy_text(from.rows_file(repetition), to.rows_file(repetition));
}

// One run, whose lock is held unless nothing is to be written.
void merge_run(const SheetRun& run, const SweepMergeConfig& config, MergeResult& result) {
  const RunFolder target(config.to, run.id);
  std::vector<Outcome> outcomes;
  for (int i = 0; i < run.repetitions; ++i) outcomes.push_back(outcome_of(target, i));
  for (const std::string& folder : config.from) {
    const RunFolder source(folder, run.id);
    if (!config.dry_run && fs::exists(source.path())) take_run(source, target);
    for (int i = 0; i < run.repetitions; ++i) {
      const Outcome offered = outcome_of(source, i);
      if (!is_wanted(offered, outcomes[i])) continue;
      if (!config.dry_run) take_repetition(source, target, i);
      outcomes[i] = offered;
      ++result.taken;
    }
  }
  result.all += outcomes.size();
  for (const Outcome& outcome : outcomes) {
    result.done += outcome.rows ? 1 : 0;
    result.failed += outcome.fault ? 1 : 0;
    result.missing += !outcome.rows && !outcome.fault ? 1 : 0;
  }
}

}  // namespace

MergeResult merge_sweeps(const SweepMergeConfig& config) {
  const SweepSheet sheet = common_sheet(config);
  MergeResult result;
  result.name = sheet.name;
  if (config.dry_run) {
    for (const SheetRun& run : sheet.runs) merge_run(run, config, result);
    return result;
  }
  make_folder(config.to);
  const FileLock lock(config.to / ".lock");
  remove_temporaries_in(config.to);
  take_files(sheet.content, config.from.front(), config.to);
  copy_text(fs::path(config.from.front()) / "sweep.json", config.to / "sweep.json");
  for (const SheetRun& run : sheet.runs) {
    const RunFolder target(config.to, run.id);
    const FileLock run_lock = target.try_lock();
    if (!run_lock.held())
      throw InputError(describe(target.path().string(), "", "another process works on it", "wait for it"));
    target.clear();
    merge_run(run, config, result);
  }
  return result;
}

}  // namespace lodestone
