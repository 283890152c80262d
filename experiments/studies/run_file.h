// A file in the folder of a run that is gone however the run ends.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include "experiments/studies/experiment.h"

namespace lodestone {

class RunFile {
 public:
  explicit RunFile(const RunContext& context, const std::string& name = "scratch.lode")
      : path_(std::filesystem::path(context.directory) / name) {}
  ~RunFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  RunFile(const RunFile&) = delete;
  RunFile& operator=(const RunFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace lodestone
