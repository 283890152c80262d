// The inputs of a sweep as files: found or generated, and identified by their content.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "experiments/sweep/sweep_file.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// A file as it was when it was hashed. What is written to it afterwards changes at least one of its times.
struct FileState {
  std::string path;
  // Size, inode, seconds and nanoseconds of the last change of the content, and of the inode. All 0: there is none.
  std::array<std::int64_t, 6> key{};

  friend bool operator==(const FileState&, const FileState&) = default;
};

struct InputFiles {
  std::vector<FileState> files;
  std::vector<std::string> folders;  // that these were found in, where a folder was asked for
};

struct SweepInput {
  std::string path;
  // Hash of the content: of the file; of a folder, the names and contents of its files; of a scene, with its models;
  // with what else belongs to it. Empty: not yet made.
  std::string sha256;
  std::uint64_t bytes = 0;
  std::shared_ptr<const InputFiles> hashed;  // what that is of; null: not yet made
};

// The first of the files that is not as it was when it was hashed, has gone, or has come to a folder. O(files).
[[nodiscard]] std::optional<std::string> changed_file(const SweepInput& input);

// SHA-256 of files, remembered in a file of the sweep's directory by size and times, so that gigabytes are not read
// again by every process. What has changed within the last seconds is not remembered: it could change again unseen.
class ContentHashes {
 public:
  // `memory` may be missing or unreadable: then everything is read.
  explicit ContentHashes(std::filesystem::path memory);
  // Throws FileError when the file, or one of the folder, cannot be read.
  [[nodiscard]] SweepInput of(const std::filesystem::path& path);
  void save() const;

 private:
  std::string of_file(const std::filesystem::path& path, InputFiles& files);

  std::filesystem::path memory_;
  Json known_;
  bool changed_ = false;
};

struct InputConfig {
  std::filesystem::path directory;  // of the sweep
  bool make = true;  // generated inputs that are missing; off: they stay without hash, and nothing is written
  bool leave_out_missing = false;  // files that are not there have no input, instead of being an error
  int threads = 0;
  const CancelFlag* cancel = nullptr;
  std::function<void(const std::string& name, double share)> progress = [](const std::string&, double) {};
};

// Inputs of the given names; generated ones are made in directory/data and kept there. The caller holds the directory's
// lock, unless nothing is to be made. Throws InputError with the line for one that is missing (unless those are left
// out) or another than its sha256 says, Cancelled.
[[nodiscard]] std::map<std::string, SweepInput> find_inputs(const SweepFile& file, const std::set<std::string>& names,
                                                            const InputConfig& config);

// "fetch it by scripts/data" of a model of this repository, or else what `otherwise` says.
[[nodiscard]] std::string remedy_for_missing(const std::filesystem::path& path, const std::string& otherwise);

// The first file of the source that is not there.
[[nodiscard]] std::optional<std::string> missing_file(const DataSource& source);

}  // namespace lodestone
