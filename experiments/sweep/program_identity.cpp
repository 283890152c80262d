#include "experiments/sweep/program_identity.h"

#include <link.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "core/files/checksum.h"
#include "core/files/input_file.h"
#include "core/files/text_file.h"
#include "experiments/command_line/version.h"
#include "experiments/subjects/result_hash.h"
#include "experiments/sweep/sha256.h"

namespace lodestone {
namespace {

// The system's run-time. What it computes is laid down by standards, and security updates replace it often: runs of
// weeks would be lost to them. libm, whose last digits differ from one version to the next, does not belong to it.
constexpr std::array run_time = {"libc.so", "libstdc++.so", "libgcc_s.so", "libpthread.so", "libdl.so", "ld-linux"};

int add_path(dl_phdr_info* info, std::size_t, void* paths) {
  const std::string path = info->dlpi_name;  // empty for the executable, without a folder for the kernel's
  if (path.find('/') != std::string::npos) static_cast<std::vector<std::string>*>(paths)->push_back(path);
  return 0;
}

std::vector<std::string> loaded_paths() {
  std::vector<std::string> paths;
  dl_iterate_phdr(add_path, &paths);
  return paths;
}

// Before anything has been loaded at run time.
const std::vector<std::string> paths_at_start = loaded_paths();

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

bool decides(const std::string& path) {
  const std::string name = file_name(path);
  const char* const preloaded = std::getenv("LD_PRELOAD");
  if (preloaded && std::string_view(preloaded).find(name) != std::string_view::npos) return false;
  return std::ranges::none_of(run_time, [&](const char* start) { return name.starts_with(start); });
}

LoadedLibrary identified(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return {path, to_hex(0)};  // replaced since it was loaded
  return {path, to_hex(checksum(MappedFile(path).bytes()))};
}

std::string hash_program() {
  std::string content = read_text("/proc/self/exe");
  const ProgramCommit commit = program_commit();
  std::string text = commit.hash + (commit.dirty ? " dirty" : "");
  text.resize(commit_size);  // as the executable has it, with zeros after it
  if (const std::size_t at = content.find(text); at != std::string::npos)
    content.replace(at, commit_size, commit_size, '\0');
  for (const LoadedLibrary& library : deciding_libraries())
    content += library.identity + "  " + file_name(library.path) + "\n";
  return sha256(content);
}

}  // namespace

std::vector<LoadedLibrary> loaded_libraries() {
  std::vector<LoadedLibrary> libraries;
  for (const std::string& path : loaded_paths()) libraries.push_back(identified(path));
  return libraries;
}

std::vector<LoadedLibrary> deciding_libraries() {
  std::vector<LoadedLibrary> libraries;
  for (const std::string& path : paths_at_start)
    if (decides(path)) libraries.push_back(identified(path));
  return libraries;
}

const std::string& program_hash() {
  static const std::string hash = hash_program();
  return hash;
}

Json program_facts() {
  const ProgramCommit commit = program_commit();
  std::vector<std::string> libraries;
  for (const LoadedLibrary& library : loaded_libraries()) libraries.push_back(library.path + " " + library.identity);
  return {{"program", program_hash()},
          {"version", program_version()},
          {"commit", commit.hash},
          {"dirty", commit.dirty},
          {"compiler", LODESTONE_COMPILER},
          {"flags", LODESTONE_FLAGS},
          {"build_type", LODESTONE_BUILD_TYPE},
          {"libraries", libraries}};
}

}  // namespace lodestone
