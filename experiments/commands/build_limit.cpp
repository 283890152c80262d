#include "experiments/commands/build_limit.h"

#include <fmt/core.h>

#include <filesystem>

#include "experiments/command_line/byte_size.h"

namespace lodestone {
namespace {

std::filesystem::path folder_of(const ModelConfig& config) {
  const std::filesystem::path folder = scratch_folder(config);
  if (config.resume) return folder;
  return folder.parent_path().empty() ? "." : folder.parent_path();
}

}  // namespace

void add_limit_options(CLI::App& command, LimitOptions& options) {
  CLI::Option* const limit =
      command
          .add_option(
              "--memory-limit", options.memory_limit,
              "Memory that may be resident, such as 2GiB or 1500MB: a mesh that needs more is built out of core, "
              "to the same bytes, from binary PLY without attributes or binary STL")
          ->transform(byte_size())
          ->type_name("SIZE");
  command.add_option("--scratch", options.scratch, "Folder for temporary files; default: that of the output")
      ->type_name("DIR")
      ->needs(limit);
  command
      .add_flag("--resume", options.resume,
                "Keep the temporary files of an interrupted or failed build, as OUT.scratch in that folder, and "
                "continue from those that are there; without it they are gone however the build ends")
      ->needs(limit);
}

void print_scratch(const ModelConfig& config, const ModelNeed& need) {
  fmt::print("temporary files: about {:.1f} MB in {}{}\n", static_cast<double>(need.scratch_bytes) * 1e-6,
             folder_of(config).string(), config.resume ? ", kept until the build is done" : "");
  std::fflush(stdout);
}

nlohmann::json scratch_results(const ModelConfig& config, const ModelNeed& need, const ModelResult& result) {
  return {{"memory_limit", config.memory_limit},
          {"scratch",
           {{"folder", folder_of(config).string()},
            {"expected_bytes", need.scratch_bytes},
            {"bytes", result.scratch_bytes},
            {"blocks", result.blocks},
            {"blocks_resumed", result.blocks_resumed}}}};
}

}  // namespace lodestone
