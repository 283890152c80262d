// lodestone merge: brings together what shards of a sweep left in folders of their own.
#include "experiments/sweep/merge.h"

#include <fmt/core.h>

#include "core/base/error.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/commands/command.h"

namespace lodestone {
namespace {

struct MergeOptions {
  std::vector<std::string> folders;
  std::string directory;
  bool dry_run = false;
};

void run(const MergeOptions& options, const CommonOptions& common) {
  check_files(common, {});
  const MergeResult result = merge_sweeps({options.folders, options.directory, options.dry_run});
  write_result(common, {{"name", result.name},
                        {"repetitions", result.all},
                        {"done", result.done},
                        {"taken", result.taken},
                        {"failed", result.failed},
                        {"missing", result.missing}});
  if (common.prints())
    fmt::print("{}: {} of {} repetitions {}taken over, {} have rows, {} failed, {} missing\n", options.directory,
               result.taken, result.all, options.dry_run ? "would be " : "", result.done, result.failed,
               result.missing);
  if (result.failed + result.missing > 0 && !options.dry_run)
    throw NegativeResult(fmt::format("{}: of {} repetitions, {} failed and {} are missing", options.directory,
                                     result.all, result.failed, result.missing));
}

OptionTable declare(MergeOptions& o) {
  return {OptionSpec{"FOLDERS", &o.folders, "Folders of one sweep, as `sweep --shard` left them"}.must(),
          OptionSpec{"-o,--output", &o.directory, "Folder of the whole sweep; made if it is not there"}.must(),
          {"--dry-run", &o.dry_run, "Count what would be taken over, and write nothing"}};
}

}  // namespace

void add_merge(CommandTable& commands) {
  define_command<MergeOptions>(
      commands,
      {"merge", "Bring the shards of a sweep together; status 1 when repetitions failed or are missing",
       "  lodestone merge part1 part2 -o ablation\n"},
      declare, run);
}

}  // namespace lodestone
