#include "experiments/sweep/parameter_files.h"

#include "core/files/text_file.h"
#include "experiments/sweep/files.h"
#include "experiments/sweep/sha256.h"
#include "experiments/sweep/sweep_file.h"
#include "render/scene/toml_table.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

ParameterFile read_file(const fs::path& path) {
  auto content = std::make_shared<const std::string>(read_text(path));
  const std::string hash = sha256(*content);
  return {hash, "data/" + hash.substr(0, 16) + path.extension().string(), std::move(content)};
}

}  // namespace

ParameterFiles read_parameter_files(const SweepFile& file) {
  ParameterFiles files;
  for (const SweepSection& section : file.sweeps)
    for (const Json& setting : section.settings)
      for (const ParameterInfo& info : section.experiment->parameters) {
        if (!setting.contains(info.name) || !names_file(info, setting.at(info.name))) continue;
        const std::string& name = setting.at(info.name).string();
        if (!files.contains(name)) files[name] = read_file(beside(file.file, name));
      }
  return files;
}

ParameterFiles files_of(const Json& parameters, const std::vector<ParameterInfo>& known, const ParameterFiles& named) {
  ParameterFiles files;
  for (const ParameterInfo& info : known)
    if (const ParameterValue& value = parameters.at(info.name); names_file(info, value))
      files[info.name] = named.at(value.get<std::string>());
  return files;
}

void write_copies(const ParameterFiles& files, const fs::path& folder) {
  for (const auto& [name, file] : files)
    if (read_if_there(folder / file.copy) != *file.content) write_durably(folder / file.copy, *file.content);
}

Json with_hashes(Json parameters, const ParameterFiles& of_run) {
  for (const auto& [name, file] : of_run) parameters[name] = file.sha256;
  return parameters;
}

Json with_copies(Json parameters, const ParameterFiles& of_run, const fs::path& folder) {
  for (const auto& [name, file] : of_run) parameters[name] = (folder / file.copy).string();
  return parameters;
}

Json files_json(const ParameterFiles& files) {
  Json json = Json::object();
  for (const auto& [name, file] : files) json[name] = {{"path", file.copy}, {"sha256", file.sha256}};
  return json;
}

}  // namespace lodestone
