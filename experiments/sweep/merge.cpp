#include "experiments/sweep/merge.h"

#include <algorithm>
#include <set>

#include "core/base/error.h"
#include "experiments/sweep/files.h"
#include "experiments/sweep/run_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

// sweep.json; where files lie on the machine that wrote it decides nothing.
nlohmann::json sweep_of(const fs::path& folder) {
  nlohmann::json sweep = read_json(folder / "sweep.json");
  if (!sweep.is_object() || !sweep.contains("sweeps"))
    throw InputError(describe(folder.string(), "", "holds no sweep", "name folders that lodestone sweep has written"));
  for (auto& [name, data] : sweep["data"].items()) data.erase("path");
  return sweep;
}

void copy_text(const fs::path& from, const fs::path& to) { write_durably(to, read_text(from)); }

// Files that parameters name: each by its content, so that one that is there is the same.
void take_files(const nlohmann::json& sweep, const fs::path& from, const fs::path& to) {
  for (const nlohmann::json& file : sweep.value("files", nlohmann::json::object())) {
    const fs::path copy = file.at("path").get<std::string>();
    make_folder((to / copy).parent_path());
    if (!fs::exists(to / copy)) copy_text(from / copy, to / copy);
  }
}

// Each run of the sweep once, with its repetitions.
std::vector<std::pair<std::string, int>> runs_in(const nlohmann::json& sweep) {
  std::vector<std::pair<std::string, int>> runs;
  for (const nlohmann::json& section : sweep.at("sweeps"))
    for (const nlohmann::json& run : section.at("runs")) {
      const std::string id = run.at("id");
      const int repetitions = section.at("repetitions");
      const auto known = std::find_if(runs.begin(), runs.end(), [&](const auto& r) { return r.first == id; });
      if (known == runs.end())
        runs.emplace_back(id, repetitions);
      else
        known->second = std::max(known->second, repetitions);
    }
  return runs;
}

// What belongs to the run and not to a repetition, where `to` has none.
void take_run(const RunFolder& from, const RunFolder& to) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(from.path(), ignored)) {
    const fs::path name = entry.path().filename();
    const bool wanted = name == "parameters.json" || name == "log.txt" || name.extension() == ".png";
    if (wanted && !fs::exists(to.path() / name)) copy_text(entry.path(), to.path() / name);
  }
}

// In the order of RunFolder::take_over(). False when there is nothing to take.
bool take_repetition(const RunFolder& from, const RunFolder& to, int repetition) {
  const bool has_rows = from.has_rows(repetition);
  if (to.has_rows(repetition) || (!has_rows && !from.fault(repetition))) return false;
  if (!has_rows && to.fault(repetition)) return false;
  copy_text(from.manifest_file(repetition), to.manifest_file(repetition));
  if (from.fault(repetition))
    copy_text(from.fault_file(repetition), to.fault_file(repetition));
  else
    fs::remove(to.fault_file(repetition));
  if (has_rows) copy_text(from.rows_file(repetition), to.rows_file(repetition));
  return true;
}

}  // namespace

MergeResult merge_sweeps(const std::vector<std::string>& from, const fs::path& to) {
  const nlohmann::json sweep = sweep_of(from.front());
  for (const std::string& other : from)
    if (sweep_of(other) != sweep)
      throw InputError(describe(other, "", "is not the same sweep as " + from.front(),
                                "merge what the same program has made of the same file and data"));
  make_folder(to);
  const FileLock lock(to / ".lock");
  remove_temporaries_in(to);
  if (fs::exists(to / "sweep.json") && sweep_of(to) != sweep)
    throw InputError(describe(to.string(), "", "holds another sweep", "choose another folder"));
  take_files(sweep, from.front(), to);
  copy_text(fs::path(from.front()) / "sweep.json", to / "sweep.json");

  MergeResult result;
  result.name = sweep.at("name");
  for (const auto& [id, repetitions] : runs_in(sweep)) {
    const RunFolder target(to, id);
    const FileLock run_lock = target.try_lock();
    if (!run_lock.held())
      throw InputError(describe(target.path().string(), "", "another process works on it", "wait for it"));
    target.clear();
    for (const std::string& other : from) {
      const RunFolder source(other, id);
      if (fs::exists(source.path())) take_run(source, target);
      for (int i = 0; i < repetitions; ++i) result.taken += take_repetition(source, target, i) ? 1 : 0;
    }
    for (int i = 0; i < repetitions; ++i) {
      ++result.repetitions;
      result.done += target.has_rows(i) ? 1 : 0;
      result.failed += target.fault(i) ? 1 : 0;
    }
  }
  return result;
}

}  // namespace lodestone
