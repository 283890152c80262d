#include "experiments/sweep/directory.h"

#include <fmt/core.h>

#include "core/base/error.h"
#include "experiments/sweep/files.h"
#include "experiments/sweep/sheet.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

// Runs with a repetition that has ended.
std::size_t runs_with_results(const fs::path& directory) {
  std::size_t count = 0;
  std::error_code ignored;
  for (const auto& run : fs::directory_iterator(directory / "runs", ignored)) {
    bool has_results = false;
    for (const auto& entry : fs::directory_iterator(run.path(), ignored)) {
      const std::string name = entry.path().filename().string();
      has_results |= entry.path().extension() == ".jsonl" || name.starts_with("fault.");
    }
    count += has_results ? 1 : 0;
  }
  return count;
}

}  // namespace

void check_directory(const fs::path& directory, const std::string& sweep, bool resume) {
  std::error_code ignored;
  const std::string name = directory.string();
  if (name.empty()) throw InputError("--output: the folder name is empty");
  if (!fs::exists(directory, ignored)) return;
  if (!fs::is_directory(directory, ignored)) throw InputError(describe(name, "", "is a file", "name a folder"));
  const std::optional<SweepSheet> before = read_sheet(directory);
  if (before && before->name != sweep)
    throw InputError(describe(name, "", "holds the sweep '" + before->name + "'", "choose another folder"));
  if (!before && !fs::exists(directory / ".lock", ignored) && !fs::is_empty(directory, ignored))
    throw InputError(describe(name, "", "holds other files and no sweep", "choose an empty folder"));
  const std::size_t results = resume ? 0 : runs_with_results(directory);
  if (results > 0)
    throw InputError(describe(name, "", fmt::format("holds results of {} runs", results),
                              "add --resume to run only what is missing, or choose another folder"));
}

SweepPlan prepare_directory(const SweepFile& file, const InputConfig& config) {
  make_folder(config.directory);
  const FileLock lock(config.directory / ".lock", config.cancel);
  remove_temporaries_in(config.directory);
  SweepPlan plan = make_plan(file, find_inputs(file, data_names(file), config));
  write_copies(file.files, config.directory);
  const std::string text = plan.json.dump(1) + "\n";
  const fs::path target = config.directory / "sweep.json";
  if (read_if_there(target) != text) write_durably(target, text);
  return plan;
}

}  // namespace lodestone
