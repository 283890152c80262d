// lodestone-mpi export: a tileset by all processes of an MPI job (docs/cluster.md).
#include <fmt/core.h>

#include <optional>

#include "core/base/error.h"
#include "core/mesh/up_axis.h"
#include "experiments/commands/input.h"
#include "experiments/mpi/job.h"
#include "experiments/subjects/tiles.h"
#include "parallel/distributed/rank_tiles.h"

namespace lodestone {
namespace {

struct ExportOptions {
  std::string file, tiles;
  std::optional<std::string> up;
  bool morph = false;
  double timeout = 600;
};

void run(const ExportOptions& options, const CommonOptions& common, Transport& transport) {
  const bool is_first = transport.rank() == 0;
  std::vector<FileArgument> outputs;
  if (is_tile_archive(options.tiles)) outputs.push_back({"--tiles", options.tiles});
  if (is_first) check_files(common, {{"FILE", options.file}}, outputs);
  Ranks ranks(transport);
  const CpuClock clock;
  const auto scheduler = make_scheduler(common);
  Progress progress = job_progress("writing", common, transport.rank());
  progress.phase("writing");
  Json rows;
  RankTilesConfig config;
  config.tiles.tileset.morph = options.morph;
  config.tiles.progress = [&](double share) { progress.update(share); };
  if (options.up) config.up = up_axis(*options.up);
  config.last_words = [&](const RankTiles& own) {
    rows = rank_rows(ranks, clock, {{"tiles", own.own_tiles}, {"triangles", own.own_triangles}});
  };
  std::optional<AtomicFolder> folder;
  if (is_first) folder.emplace(tile_folder(options.tiles));
  RankTiles result = save_rank_tiles(options.file, folder ? &*folder : nullptr, config, ranks, *scheduler);
  if (!is_first) return;

  finish_tiles(*folder, options.tiles, interrupt_flag(), result.saved);
  progress.clear();
  Json json = to_json(result.saved, options.tiles, result.finest_triangles);
  json.update({{"seconds", clock.elapsed().seconds}, {"threads", scheduler->workers()}, {"ranks", rows}});
  write_result(common, json);
  if (!common.prints()) return;
  fmt::print("{}", summary(result.saved, options.tiles));
  print_warnings(result.saved.warnings);
}

void check(const ExportOptions& options) {
  if (options.tiles.empty()) throw UsageError("--tiles: the folder name is empty");
}

OptionTable declare(ExportOptions& o) {
  return {OptionSpec{"FILE", &o.file, "Hierarchy (.lode)"}.must(),
          OptionSpec{"--tiles", &o.tiles,
                     "Folder to write, new or empty, which all machines share; or an archive of it (.3tz)"}
              .must(),
          up_option(o.up),
          {"--morph", &o.morph, "As for lodestone export"},
          timeout_option(o.timeout)};
}

}  // namespace

void add_export_job(CommandTable& commands, MpiTransport& transport) {
  add_job<ExportOptions>(commands, transport,
                         {"export", "Write a hierarchy as a tileset by all processes of an MPI job",
                          "  mpirun -n 4 lodestone-mpi export statue.lode --tiles tileset --morph --threads 2\n"},
                         {declare, check, run});
}

}  // namespace lodestone
