// lodestone export: one level of a hierarchy as a mesh file, or all of it as a tileset.
#include <fmt/core.h>

#include <filesystem>
#include <optional>

#include "core/base/error.h"
#include "core/files/atomic_folder.h"
#include "core/formats/mesh_file.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/mesh/up_axis.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "experiments/subjects/tiles.h"
#include "parallel/hierarchy/save.h"
#include "parallel/hierarchy/save_tiles.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

struct ExportOptions {
  std::string file;
  std::optional<std::string> output, tiles, up;
  std::optional<int> level;
  bool morph = false;
};

Hierarchy load(const ExportOptions& options, Scheduler& scheduler) {
  Hierarchy hierarchy = load_lode(options.file, scheduler);
  if (options.up) hierarchy.transform.up = {up_axis(*options.up), false};
  return hierarchy;
}

void export_level(const ExportOptions& options, const CommonOptions& common) {
  check_files(common, {{"FILE", options.file}}, {{"--output", *options.output}});
  const auto scheduler = make_scheduler(common);
  const Hierarchy hierarchy = load(options, *scheduler);
  const int level = options.level.value_or(hierarchy.finest());
  if (level > hierarchy.finest())
    throw InputError(describe(options.file, "", fmt::format("there is no level {}", level),
                              fmt::format("the finest one is {}", hierarchy.finest())));
  const RawMesh mesh = level_mesh(hierarchy, level);
  const std::vector<std::string> warnings = write_mesh(*options.output, mesh);
  write_result(common, {{"file", *options.output},
                        {"level", level},
                        {"triangles", mesh.triangles.size()},
                        {"vertices", mesh.positions.size()},
                        {"warnings", warnings}});
  if (!common.prints()) return;
  fmt::print("{}: level {} with {} triangles, {} vertices\n", *options.output, level, mesh.triangles.size(),
             mesh.positions.size());
  print_warnings(warnings);
}

void export_tiles(const ExportOptions& options, const CommonOptions& common) {
  if (options.tiles->empty()) throw UsageError("--tiles: the folder name is empty");
  std::vector<FileArgument> outputs;
  if (is_tile_archive(*options.tiles)) outputs.push_back({"--tiles", *options.tiles});
  check_files(common, {{"FILE", options.file}}, outputs);
  AtomicFolder folder(tile_folder(*options.tiles));
  const CpuClock clock;
  const auto scheduler = make_scheduler(common);
  Progress progress("writing", common.quiet);
  SaveTilesConfig config;
  config.tileset.morph = options.morph;
  config.cancel = &interrupt_flag();
  config.progress = [&](double share) { progress.update(share); };
  progress.phase("reading");
  const Hierarchy hierarchy = load(options, *scheduler);
  check_interrupt();
  std::uint64_t triangles = 0;
  for (const Level& level : hierarchy.levels) triangles += level.triangles;
  progress.phase("writing");
  progress.measure(static_cast<double>(triangles), "triangles");
  SavedTiles saved = save_tiles(hierarchy, folder, *scheduler, config);
  check_interrupt();
  finish_tiles(folder, *options.tiles, interrupt_flag(), saved);
  progress.clear();
  const StageTime time = clock.elapsed();
  Json json = to_json(saved, *options.tiles, hierarchy.levels.back().triangles);
  json.update({{"seconds", time.seconds}, {"cpu_seconds", time.cpu_seconds}});
  write_result(common, json);
  if (!common.prints()) return;
  fmt::print("{}", summary(saved, *options.tiles));
  print_warnings(saved.warnings);
}

void run(const ExportOptions& options, const CommonOptions& common) {
  if (!options.output && !options.tiles)
    throw UsageError("--output or --tiles is required; see lodestone export --help");
  options.tiles ? export_tiles(options, common) : export_level(options, common);
}

OptionTable declare(ExportOptions& o) {
  return {
      OptionSpec{"FILE", &o.file, "Hierarchy (.lode)"}.must(),
      OptionSpec{"--level", &o.level, "Level, 0 is the coarsest; the finest if not given"}.between(0, max_level),
      {"-o,--output", &o.output, "Mesh to write: .ply, .obj, .stl, or .glb with all attributes"},
      OptionSpec{
          "--tiles", &o.tiles,
          "Folder to write instead, new or empty: a 3D Tiles 1.1 tileset with a tile (.glb) per cell; or an archive "
          "of it, one file (.3tz) that streams from servers which give parts of files"}
          .not_with({"--output", "--level"}),
      up_option(o.up),
      OptionSpec{"--morph", &o.morph,
                 "With --tiles: also the attributes of every vertex's parent (_PARENT, its place, and _PARENTNORMAL, "
                 "_PARENTTEXCOORD, _PARENTCOLOR), and the figures for morphing in extras"}
          .only_with({"--tiles"})};
}

}  // namespace

void add_export(CommandTable& commands) {
  define_command<ExportOptions>(commands,
                                {"export", "Write one level of a hierarchy as a mesh, or all of it as a tileset",
                                 "  lodestone export scan.lode --level 3 -o level3.ply\n"
                                 "  lodestone export scan.lode -o finest.obj\n"
                                 "  lodestone export scan.lode --tiles tileset\n"
                                 "  lodestone export scan.lode --tiles scan.3tz --morph\n"},
                                declare, run);
}

}  // namespace lodestone
