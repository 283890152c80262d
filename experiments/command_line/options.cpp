#include "experiments/command_line/options.h"

#include <algorithm>
#include <iterator>

namespace lodestone {

void add_command(CommandTable& commands, const CommandInfo& info, CommonOptions& common, OptionTable table,
                 std::function<void()> run) {
  OptionTable all{{"--json", &common.json, "Write results as JSON to this file (- for standard output)"},
                  OptionSpec{"--threads", &common.threads, info.threads_help}.between(0, 1024),
                  {"--quiet", &common.quiet, "Print errors only, no progress and no summary"}};
  std::ranges::move(table, std::back_inserter(all));
  commands.push_back({info, std::move(all), std::move(run)});
}

const std::string& program_description() {
  static const std::string text = "Lodestone: level of detail of large triangle surfaces, without cracks or pops";
  return text;
}

}  // namespace lodestone
