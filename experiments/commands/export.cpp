// lodestone export: one level of a hierarchy as a mesh file.
#include <fmt/core.h>

#include "core/base/error.h"
#include "core/hierarchy/level_mesh.h"
#include "core/io/mesh_writer.h"
#include "experiments/commands/command.h"
#include "parallel/save.h"

namespace lodestone {
namespace {

struct ExportOptions {
  std::string file, output;
  int level = -1;
};

void run(const ExportOptions& options, const CommonOptions& common) {
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

}  // namespace

void add_export(CLI::App& app) {
  const auto common = std::make_shared<CommonOptions>();
  const auto options = std::make_shared<ExportOptions>();
  CLI::App& command = add_command(app, "export", "Write one level of a hierarchy as a mesh",
                                  "  lodestone export scan.lode --level 3 -o level3.ply\n"
                                  "  lodestone export scan.lode -o finest.obj\n",
                                  common);
  command.add_option("FILE", options->file, "Hierarchy (.lode)")->required();
  command.add_option("--level", options->level, "Level, 0 is the coarsest; the finest if not given")
      ->check(CLI::Range(0, max_level));
  command.add_option("-o,--output", options->output, "Mesh to write: .ply, .obj, .stl, or .glb with all attributes")
      ->required();
  command.callback([options, common] { run(*options, *common); });
}

}  // namespace lodestone
