// lodestone lod: a level of a progressive mesh as a mesh file.
#include <fmt/core.h>

#include <optional>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/progressive/mesh/level.h"
#include "core/progressive/progressive_file.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

struct LodOptions {
  std::string input, output;
  std::optional<std::uint32_t> vertices;
  std::optional<std::size_t> triangles;
  std::optional<double> error;
  bool prefix = false;
};

std::uint32_t choose(const LodOptions& options, const LevelFinder& levels, const ProgressiveMesh& mesh) {
  if (options.vertices) return levels.vertices_for(*options.vertices);
  if (options.triangles) return levels.vertices_for_triangles(*options.triangles);
  return levels.vertices_for_error(static_cast<float>(*options.error / mesh.transform.scale));
}

void run(const LodOptions& options, const CommonOptions& common) {
  check_files(common, {{"IN", options.input}}, {{"--output", options.output}});
  const ProgressiveMesh mesh = load_progressive(options.input, options.prefix);
  const LevelFinder levels(mesh);
  const CpuClock clock;
  const std::uint32_t vertices = choose(options, levels, mesh);
  const RawMesh raw = levels.level_mesh(vertices);
  const StageTime time = clock.elapsed();
  if (raw.triangles.empty())
    throw InputError(describe(options.input, "", "the level has no triangles", "ask for a finer one"));
  write_mesh(options.output, view_of(raw));
  const double error = levels.error_of(vertices) * mesh.transform.scale;
  write_json(common, {{"input", options.input},
                      {"output", options.output},
                      {"vertices", vertices},
                      {"triangles", raw.triangles.size()},
                      {"error", error},
                      {"level", to_json(time)},
                      {"finest_vertices", mesh.vertex_count()},
                      {"finest_triangles", mesh.triangles.size()},
                      {"base_vertices", mesh.base_vertices}});
  if (!common.quiet && common.json != "-")
    fmt::print("{}: {} triangles, {} vertices of {}, error {:g}\n", options.output, raw.triangles.size(), vertices,
               mesh.vertex_count(), error);
}

}  // namespace

void add_lod(CLI::App& app) {
  const auto common = std::make_shared<CommonOptions>();
  const auto options = std::make_shared<LodOptions>();
  CLI::App& command = add_command(app, "lod", "Take a level of a progressive mesh",
                                  "  lodestone lod statue.glb --triangles 5000 -o statue5k.ply\n"
                                  "  lodestone lod scan.lpm --error 0.5 -o coarse.obj\n",
                                  common);
  command.add_option("IN", options->input, "Progressive mesh (.lpm or .glb of `lodestone progressive`)")->required();
  CLI::Option* vertices = command.add_option("--vertices", options->vertices, "At most so many vertices");
  CLI::Option* triangles = command.add_option("--triangles", options->triangles, "At most so many triangles");
  CLI::Option* error =
      command
          .add_option("--error", options->error,
                      "The coarsest level whose estimated error is at most this, in units of the model")
          ->check(CLI::NonNegativeNumber);
  vertices->excludes(triangles)->excludes(error);
  triangles->excludes(error);
  command.add_flag("--prefix", options->prefix, "Accept an .lpm that ends early: what there is of it");
  command.add_option("-o,--output", options->output, "Mesh to write: .ply, .obj, .stl or .glb")->required();
  command.callback([options, common] {
    if (!options->vertices && !options->triangles && !options->error)
      throw CLI::RequiredError("--vertices, --triangles or --error");
    run(*options, *common);
  });
}

}  // namespace lodestone
