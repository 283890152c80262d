// The directory of one run: what is done, what went wrong, and the taking over of a finished repetition.
//
// A repetition works in a folder of its own below it, `work.R`, and leaves its results there. take_over() puts them
// where readers look: the rows last, under their name all at once, so that a process killed at any time leaves a
// repetition that is done or one that is not.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/files/json.h"
#include "experiments/sweep/files.h"
#include "experiments/sweep/plan.h"

namespace lodestone {

// Why a repetition may not be reported: "verify" (its rows are there), "error" or "crash" (it has none).
struct Fault {
  std::string kind;
  std::vector<std::string> messages;
};
[[nodiscard]] Json to_json(const Fault& fault);

// Files of a repetition, for the child that works in `work.R` and the parent that takes them over.
struct WorkFolder {
  std::filesystem::path path;
  [[nodiscard]] std::filesystem::path job() const { return path / "job.json"; }
  [[nodiscard]] std::filesystem::path rows() const { return path / "rows.jsonl"; }
  [[nodiscard]] std::filesystem::path manifest() const { return path / "manifest.json"; }
  [[nodiscard]] std::filesystem::path fault() const { return path / "fault.json"; }
  [[nodiscard]] std::filesystem::path scratch() const { return path / "files"; }  // the experiment's
};

// The files of an experiment that stay with its run: pictures, animated ones too.
[[nodiscard]] bool is_picture(const std::filesystem::path& file);

class RunFolder {
 public:
  RunFolder(const std::filesystem::path& directory, const std::string& id) : path_(directory / "runs" / id) {}

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path rows_file(int repetition) const;
  [[nodiscard]] std::filesystem::path manifest_file(int repetition) const;
  [[nodiscard]] std::filesystem::path fault_file(int repetition) const;
  [[nodiscard]] std::filesystem::path log() const { return path_ / "log.txt"; }

  [[nodiscard]] bool has_rows(int repetition) const;
  [[nodiscard]] std::optional<Fault> fault(int repetition) const;
  // Tells one fault of a repetition from a later one; empty: there is none.
  [[nodiscard]] std::string fault_mark(int repetition) const;
  // Seconds that a finished repetition took; nothing where that is not known.
  [[nodiscard]] std::optional<double> seconds(int repetition) const;

  // Makes the directory. Not held while another process works on the run.
  [[nodiscard]] FileLock try_lock() const;
  // Takes away what killed processes have left, unless another one is at work.
  void tidy() const;

  // All of these need the lock.
  void describe_run(const SweepRun& run) const;          // parameters.json
  void clear() const;                                    // what tidy() takes away
  [[nodiscard]] WorkFolder begin(int repetition) const;  // an empty work folder
  // Rows, manifest (with `facts` besides what the child wrote), pictures and fault appear, the work folder goes.
  // `fault` is the parent's verdict: what the child left is then not looked at, but for its manifest.
  std::optional<Fault> take_over(int repetition, const Json& facts, std::optional<Fault> fault) const;

 private:
  std::filesystem::path path_;
};

}  // namespace lodestone
