// Files that parameters name, as a recorded camera path.
//
// A run is known by their content and not by their names. What it reads is a copy in the sweep's folder: whatever
// happens to the file afterwards, the run is what it says it is, and can be repeated wherever the folder goes.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/files/json.h"
#include "experiments/studies/experiment.h"

namespace lodestone {

struct SweepFile;

struct ParameterFile {
  std::string sha256;
  std::string copy;  // where it lies in the sweep's folder: data/0123456789abcdef.json
  std::shared_ptr<const std::string> content;
};
using ParameterFiles = std::map<std::string, ParameterFile>;

// All that the settings of the sweeps name, by their names in the sweep file. They have been looked into.
[[nodiscard]] ParameterFiles read_parameter_files(const SweepFile& file);
// Those of one run, by parameter.
[[nodiscard]] ParameterFiles files_of(const Json& parameters, const std::vector<ParameterInfo>& known,
                                      const ParameterFiles& named);

// Writes copies that are missing. The caller holds the folder's lock. Throws FileError.
void write_copies(const ParameterFiles& files, const std::filesystem::path& folder);

// The parameters with the hashes of these files instead of their names, and with the paths of their copies.
[[nodiscard]] Json with_hashes(Json parameters, const ParameterFiles& of_run);
[[nodiscard]] Json with_copies(Json parameters, const ParameterFiles& of_run, const std::filesystem::path& folder);
// name -> {"path": the copy, relative to the sweep's folder, "sha256"}.
[[nodiscard]] Json files_json(const ParameterFiles& files);

}  // namespace lodestone
