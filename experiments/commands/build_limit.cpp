#include "experiments/commands/build_limit.h"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include "core/base/error.h"

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

std::uint64_t parse_size(const std::string& text) {
  constexpr std::array<std::pair<std::string_view, double>, 14> units{{{"", 1},
                                                                       {"B", 1},
                                                                       {"K", 0x1p10},
                                                                       {"M", 0x1p20},
                                                                       {"G", 0x1p30},
                                                                       {"T", 0x1p40},
                                                                       {"KiB", 0x1p10},
                                                                       {"MiB", 0x1p20},
                                                                       {"GiB", 0x1p30},
                                                                       {"TiB", 0x1p40},
                                                                       {"kB", 1e3},
                                                                       {"MB", 1e6},
                                                                       {"GB", 1e9},
                                                                       {"TB", 1e12}}};
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [unit, error] = std::from_chars(text.data(), end, number);
  if (error == std::errc{} && number > 0 && std::isfinite(number))
    for (const auto& [name, factor] : units)
      if (std::string_view(unit, static_cast<std::size_t>(end - unit)) == name && number * factor < 0x1p63)
        return static_cast<std::uint64_t>(number * factor);
  throw InputError(
      describe("--memory-limit", "", "'" + text + "' is no size", "give a number and a unit, such as 2GiB or 1500MB"));
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
