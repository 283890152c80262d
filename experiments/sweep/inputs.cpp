#include "experiments/sweep/inputs.h"

#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <vector>

#include "core/base/error.h"
#include "experiments/sweep/files.h"
#include "experiments/sweep/sha256.h"
#include "parallel/mesh/generate.h"
#include "render/scene/scene_file.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

// No known file system has file times coarser than this, in seconds.
constexpr std::time_t settled_after = 3;

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (entry->is_regular_file()) files.push_back(entry->path());
  if (error) throw FileError(describe(folder.string(), "", "cannot be read: " + error.message()));
  std::sort(files.begin(), files.end());
  return files;
}

FileState state_of(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return {path.string()};
  return {path.string(),
          {status.st_size, static_cast<std::int64_t>(status.st_ino), status.st_mtim.tv_sec, status.st_mtim.tv_nsec,
           status.st_ctim.tv_sec, status.st_ctim.tv_nsec}};
}

void append(InputFiles& files, const InputFiles& more) {
  files.files.insert(files.files.end(), more.files.begin(), more.files.end());
  files.folders.insert(files.folders.end(), more.folders.begin(), more.folders.end());
}

[[noreturn]] void fail(const SweepFile& file, const DataSource& source, const std::string& what,
                       const std::string& remedy) {
  throw InputError(describe(file.file, source.place, source.name + ": " + what, remedy));
}

// The sources of our models are known (scripts/models.toml); those of other models are not.
bool is_ours(const fs::path& path) {
  return fs::absolute(path).lexically_normal().generic_string().find("/build/data/") != std::string::npos;
}

// Files that are read besides the one that is named.
std::vector<std::string> companions_of(const DataSource& source) {
  std::vector<std::string> files = source.with;
  if (!is_scene_file(source.path)) return files;
  const Scene scene = read_scene(source.path);
  for (const SceneModel& model : scene.models)
    if (!model.generate) files.push_back(model.file);
  std::error_code ignored;
  if (fs::is_regular_file(scene.camera.path, ignored)) files.push_back(scene.camera.path);
  return files;
}

SweepInput find_file(const SweepFile& file, const DataSource& source, ContentHashes& hashes) {
  if (const std::optional<std::string> path = missing_file(source))
    fail(file, source, *path + " is missing", remedy_for_missing(*path, "correct the path, or put the file there"));
  SweepInput input = hashes.of(source.path);
  if (!source.sha256.empty() && input.sha256 != source.sha256)
    fail(file, source, fmt::format("{} has the sha256 {}, not {}", source.path, input.sha256, source.sha256),
         remedy_for_missing(source.path, "take the right file") + ", or correct the sha256");
  const std::vector<std::string> companions = companions_of(source);
  if (companions.empty()) return input;
  std::string hashes_of_all = input.sha256 + "\n";
  InputFiles files = *input.hashed;
  for (const std::string& companion : companions) {
    const SweepInput part = hashes.of(companion);
    hashes_of_all += part.sha256 + "\n";
    input.bytes += part.bytes;
    append(files, *part.hashed);
  }
  input.sha256 = sha256(hashes_of_all);
  input.hashed = std::make_shared<InputFiles>(std::move(files));
  return input;
}

SweepInput find_generated(const DataSource& source, ContentHashes& hashes, const InputConfig& config) {
  const fs::path target = config.directory / "data" /
                          fmt::format("{}-{}-{}.ply", source.shape, source.generate->triangles, source.generate->seed);
  if (!fs::exists(target)) {
    if (!config.make) return {target.string(), "", 0, nullptr};
    const auto scheduler = make_tbb_scheduler(config.threads);
    (void)generate_ply(*source.generate, target, *scheduler, config.cancel,
                       [&](double share) { config.progress(source.name, share); });
  }
  return hashes.of(target);
}

}  // namespace

std::optional<std::string> changed_file(const SweepInput& input) {
  if (!input.hashed) return {};
  std::set<std::string> known;
  for (const FileState& file : input.hashed->files) {
    if (state_of(file.path) != file) return file.path;
    known.insert(file.path);
  }
  for (const std::string& folder : input.hashed->folders) {
    if (!fs::is_directory(folder)) return folder;
    for (const fs::path& file : files_below(folder))
      if (!known.contains(file.string())) return file.string();
  }
  return {};
}

ContentHashes::ContentHashes(fs::path memory) : memory_(std::move(memory)), known_(read_json(memory_)) {
  if (!known_.is_object()) known_ = Json::object();
}

std::string ContentHashes::of_file(const fs::path& path, InputFiles& files) {
  const FileState state = state_of(path);  // before its content is read
  if (state == FileState{path.string()}) throw FileError(describe(path.string(), "", "cannot be read"));
  files.files.push_back(state);
  const Json key = state.key;
  const std::string name = fs::absolute(path).lexically_normal().string();
  if (const Json* const found = known_.find(name); found && found->value("key", Json()) == key)
    return found->value("sha256", "");
  const std::string hash = sha256_of_file(path);
  if (std::time(nullptr) - state.key[4] > settled_after) {
    known_[name] = {{"key", key}, {"sha256", hash}};
    changed_ = true;
  }
  return hash;
}

SweepInput ContentHashes::of(const fs::path& path) {
  SweepInput input{path.string(), "", 0, nullptr};
  InputFiles files;
  if (!fs::is_directory(path)) {
    input.sha256 = of_file(path, files);
  } else {
    files.folders.push_back(path.string());
    std::string all;
    for (const fs::path& file : files_below(path))
      all += of_file(file, files) + "  " + fs::relative(file, path).generic_string() + "\n";
    input.sha256 = sha256(all);
  }
  for (const FileState& file : files.files) input.bytes += static_cast<std::uint64_t>(file.key[0]);
  input.hashed = std::make_shared<InputFiles>(std::move(files));
  return input;
}

void ContentHashes::save() const {
  if (changed_) write_aside(memory_, known_.dump(1) + "\n");
}

std::string remedy_for_missing(const fs::path& path, const std::string& otherwise) {
  return is_ours(path) ? "get the models by scripts/data" : otherwise;
}

std::optional<std::string> missing_file(const DataSource& source) {
  std::error_code ignored;
  if (source.generate) return {};
  if (!fs::exists(source.path, ignored)) return source.path;
  for (const std::string& companion : companions_of(source))
    if (!fs::exists(companion, ignored)) return companion;
  return {};
}

std::map<std::string, SweepInput> find_inputs(const SweepFile& file, const std::set<std::string>& names,
                                              const InputConfig& config) {
  ContentHashes hashes(config.directory / "data" / "hashes.json");
  if (config.make) {
    make_folder(config.directory / "data");
    remove_temporaries_in(config.directory / "data");
  }
  std::map<std::string, SweepInput> inputs;
  for (const DataSource& source : file.data) {
    if (!names.contains(source.name)) continue;
    if (config.leave_out_missing && missing_file(source)) continue;
    inputs[source.name] = source.generate ? find_generated(source, hashes, config) : find_file(file, source, hashes);
  }
  if (config.make) hashes.save();
  return inputs;
}

}  // namespace lodestone
