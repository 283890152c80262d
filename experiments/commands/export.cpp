// lodestone export: one level of a hierarchy as a mesh file, or all of it as a tileset.
#include <fmt/core.h>

#include <optional>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/hierarchy/model/level_mesh.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "parallel/build/save.h"
#include "parallel/build/save_tiles.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

struct ExportOptions {
  std::string file, output, tiles;
  int level = -1;
  bool morph = false;
};

void export_level(const ExportOptions& options, const CommonOptions& common) {
  check_files(common, {{"FILE", options.file}}, {{"--output", options.output}});
  const auto scheduler = make_scheduler(common);
  const Hierarchy hierarchy = load_lode(options.file, *scheduler);
  const int level = options.level < 0 ? hierarchy.finest() : options.level;
  if (level > hierarchy.finest())
    throw InputError(describe(options.file, "", fmt::format("there is no level {}", level),
                              fmt::format("the finest one is {}", hierarchy.finest())));
  const RawMesh mesh = level_mesh(hierarchy, level);
  write_mesh(options.output, view_of(mesh));
  write_json(common, {{"file", options.output},
                      {"level", level},
                      {"triangles", mesh.triangles.size()},
                      {"vertices", mesh.positions.size()}});
  if (!common.quiet && common.json != "-")
    fmt::print("{}: level {} with {} triangles, {} vertices\n", options.output, level, mesh.triangles.size(),
               mesh.positions.size());
}

void export_tiles(const ExportOptions& options, const CommonOptions& common) {
  if (options.tiles.empty()) throw InputError("--tiles: the folder name is empty");
  check_files(common, {{"FILE", options.file}});
  AtomicFolder folder(options.tiles);
  const CpuClock clock;
  const auto scheduler = make_scheduler(common);
  Progress progress("writing", common.quiet);
  SaveTilesConfig config;
  config.tileset.morph = options.morph;
  config.cancel = &interrupt_flag();
  config.progress = [&](double share) { progress.update(share); };
  progress.phase("reading");
  const Hierarchy hierarchy = load_lode(options.file, *scheduler);
  check_interrupt();
  std::uint64_t triangles = 0;
  for (const Level& level : hierarchy.levels) triangles += level.triangles;
  progress.phase("writing");
  progress.measure(static_cast<double>(triangles), "triangles");
  const SavedTiles saved = save_tiles(hierarchy, folder, *scheduler, config);
  check_interrupt();
  folder.commit();
  progress.clear();
  const StageTime time = clock.elapsed();
  write_json(common, {{"folder", options.tiles},
                      {"tiles", saved.tiles},
                      {"tilesets", saved.tilesets},
                      {"textures", saved.textures},
                      {"triangles", saved.triangles},
                      {"finest_triangles", hierarchy.levels.back().triangles},
                      {"bytes", saved.bytes},
                      {"seconds", time.seconds},
                      {"cpu_seconds", time.cpu_seconds}});
  if (!common.quiet && common.json != "-")
    fmt::print("{}: {} tiles, {} tilesets, {} images, {} triangles, {:.1f} MB\n", options.tiles, saved.tiles,
               saved.tilesets, saved.textures, saved.triangles, static_cast<double>(saved.bytes) * 1e-6);
}

void run(const ExportOptions& options, const CommonOptions& common, bool tiles) {
  tiles ? export_tiles(options, common) : export_level(options, common);
}

}  // namespace

void add_export(CLI::App& app) {
  const auto common = std::make_shared<CommonOptions>();
  const auto options = std::make_shared<ExportOptions>();
  CLI::App& command = add_command(app, "export", "Write one level of a hierarchy as a mesh, or all of it as a tileset",
                                  "  lodestone export scan.lode --level 3 -o level3.ply\n"
                                  "  lodestone export scan.lode -o finest.obj\n"
                                  "  lodestone export scan.lode --tiles tileset\n",
                                  common);
  command.add_option("FILE", options->file, "Hierarchy (.lode)")->required();
  CLI::Option* level =
      command.add_option("--level", options->level, "Level, 0 is the coarsest; the finest if not given")
          ->check(CLI::Range(0, max_level));
  CLI::Option* output = command.add_option("-o,--output", options->output,
                                           "Mesh to write: .ply, .obj, .stl, or .glb with all attributes");
  CLI::Option* tiles =
      command.add_option("--tiles", options->tiles,
                         "Folder to write instead, new or empty: a 3D Tiles 1.1 tileset with a tile (.glb) per cell");
  CLI::Option* morph =
      command.add_flag("--morph", options->morph,
                       "With --tiles: also what every vertex's parent has (_PARENT, its place, and _PARENTNORMAL, "
                       "_PARENTTEXCOORD, _PARENTCOLOR), "
                       "and the figures for morphing in extras");
  tiles->excludes(output)->excludes(level);
  morph->needs(tiles);
  command.callback([options, common, output, tiles] {
    if (output->count() + tiles->count() == 0) throw CLI::RequiredError("--output or --tiles");
    run(*options, *common, tiles->count() > 0);
  });
}

}  // namespace lodestone
