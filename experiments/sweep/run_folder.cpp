#include "experiments/sweep/run_folder.h"

#include <fmt/core.h>
#include <sys/stat.h>

#include <system_error>

#include "core/base/error.h"
#include "core/files/text_file.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

std::string text_of(const Json& json) { return json.dump(1) + "\n"; }

std::optional<Fault> fault_of(const Json& json) {
  if (!json.is_object()) return {};
  return Fault{json.value("kind", "error"), json.value("messages", std::vector<std::string>{})};
}

// Work folders and temporaries of files.
std::vector<fs::path> leftovers(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("work.") || name.find(".tmp.") != std::string::npos) found.push_back(entry.path());
  }
  return found;
}

// Other files of the experiment go with the work folder.
void keep_pictures(const fs::path& from, const fs::path& to) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(from, ignored)) {
    if (!is_picture(entry.path())) continue;
    std::error_code error;
    fs::rename(entry.path(), to / entry.path().filename(), error);
    if (error)
      throw FileError(describe((to / entry.path().filename()).string(), "", "cannot be written: " + error.message()));
  }
}

}  // namespace

bool is_picture(const fs::path& file) { return file.extension() == ".png" || file.extension() == ".webp"; }

Json to_json(const Fault& fault) { return {{"kind", fault.kind}, {"messages", fault.messages}}; }

fs::path RunFolder::rows_file(int repetition) const { return path_ / fmt::format("rows.{}.jsonl", repetition); }
fs::path RunFolder::manifest_file(int repetition) const { return path_ / fmt::format("manifest.{}.json", repetition); }
fs::path RunFolder::fault_file(int repetition) const { return path_ / fmt::format("fault.{}.json", repetition); }

bool RunFolder::has_rows(int repetition) const { return fs::exists(rows_file(repetition)); }

std::optional<Fault> RunFolder::fault(int repetition) const { return fault_of(read_json(fault_file(repetition))); }

std::string RunFolder::fault_mark(int repetition) const {
  struct stat status {};
  if (stat(fault_file(repetition).c_str(), &status) != 0) return {};
  return fmt::format("{}.{}.{}", status.st_ino, status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
}

std::optional<double> RunFolder::seconds(int repetition) const {
  const Json manifest = read_json(manifest_file(repetition));
  if (!manifest.is_object() || !manifest.contains("wall_seconds")) return {};
  return manifest.at("wall_seconds").get<double>();
}

FileLock RunFolder::try_lock() const {
  make_folder(path_);
  return FileLock::try_lock(path_ / ".lock");
}

void RunFolder::describe_run(const SweepRun& run) const {
  const std::string text = text_of({{"experiment", run.experiment->name},
                                    {"data", run.data},
                                    {"input", run.input.path},
                                    {"input_sha256", run.input.sha256},
                                    {"program", run.program},
                                    {"parameters", run.parameters},
                                    {"files", files_json(run.files)}});
  const fs::path target = path_ / "parameters.json";
  if (read_if_there(target) != text) write_durably(target, text);
}

void RunFolder::tidy() const {
  if (leftovers(path_).empty()) return;
  const FileLock lock = try_lock();
  if (lock.held()) clear();
}

void RunFolder::clear() const {
  std::error_code ignored;
  for (const fs::path& path : leftovers(path_)) fs::remove_all(path, ignored);
}

WorkFolder RunFolder::begin(int repetition) const {
  const WorkFolder work{path_ / fmt::format("work.{}", repetition)};
  std::error_code ignored;
  fs::remove_all(work.path, ignored);
  make_folder(work.scratch());
  return work;
}

std::optional<Fault> RunFolder::take_over(int repetition, const Json& facts, std::optional<Fault> fault) const {
  const WorkFolder work{path_ / fmt::format("work.{}", repetition)};
  if (!fault) fault = fault_of(read_json(work.fault()));
  const bool has_rows = !fault || fault->kind == "verify";
  Json manifest = read_json(work.manifest());
  if (!manifest.is_object()) manifest = Json::object();
  manifest.update(facts);
  write_durably(manifest_file(repetition), text_of(manifest));
  keep_pictures(work.scratch(), path_);
  // The fault of rows that do not verify has to be there first. That of an earlier attempt has to go first.
  if (fault)
    write_durably(fault_file(repetition), text_of(to_json(*fault)));
  else
    fs::remove(fault_file(repetition));
  if (has_rows) write_durably(rows_file(repetition), read_text(work.rows()));
  std::error_code ignored;
  fs::remove_all(work.path, ignored);
  return fault;
}

}  // namespace lodestone
