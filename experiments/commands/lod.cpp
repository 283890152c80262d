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
  std::optional<std::uint64_t> triangles;
  std::optional<double> error;
  bool prefix = false;
};

std::uint32_t choose(const LodOptions& options, const LevelFinder& levels, const ProgressiveMesh& mesh) {
  if (options.vertices) return levels.vertices_for(*options.vertices);
  if (options.triangles) return levels.vertices_for_triangles(*options.triangles);
  return levels.vertices_for_error(static_cast<float>(*options.error / mesh.transform.scale));
}

void run(const LodOptions& options, const CommonOptions& common) {
  if (!options.vertices && !options.triangles && !options.error)
    throw InputError("--vertices, --triangles or --error is required; see lodestone lod --help");
  check_files(common, {{"IN", options.input}}, {{"--output", options.output}});
  const ProgressiveMesh mesh = load_progressive(options.input, options.prefix);
  const LevelFinder levels(mesh);
  const CpuClock clock;
  const std::uint32_t vertices = choose(options, levels, mesh);
  const RawMesh raw = levels.level_mesh(vertices);
  const StageTime time = clock.elapsed();
  if (raw.triangles.empty())
    throw InputError(describe(options.input, "", "the level has no triangles", "ask for a finer one"));
  const std::vector<std::string> warnings = write_mesh(options.output, view_of(raw));
  const double error = levels.error_of(vertices) * mesh.transform.scale;
  write_result(common, {{"input", options.input},
                        {"output", options.output},
                        {"vertices", vertices},
                        {"triangles", raw.triangles.size()},
                        {"error", error},
                        {"level", to_json(time)},
                        {"finest_vertices", mesh.vertex_count()},
                        {"finest_triangles", mesh.triangles.size()},
                        {"base_vertices", mesh.base_vertices},
                        {"warnings", warnings}});
  if (!common.prints()) return;
  fmt::print("{}: {} triangles, {} vertices of {}, error {:g}\n", options.output, raw.triangles.size(), vertices,
             mesh.vertex_count(), error);
  print_warnings(warnings);
}

OptionTable declare(LodOptions& o) {
  return {
      OptionSpec{"IN", &o.input, "Progressive mesh (.lpm or .glb of `lodestone progressive`)"}.must(),
      {"--vertices", &o.vertices, "Maximum number of vertices"},
      OptionSpec{"--triangles", &o.triangles, "Maximum number of triangles"}.not_with({"--vertices"}),
      OptionSpec{"--error", &o.error, "The coarsest level whose estimated error is at most this, in units of the model"}
          .at_least(0)
          .not_with({"--vertices", "--triangles"}),
      {"--prefix", &o.prefix, "Accept an .lpm that ends early: the part of it that is there"},
      OptionSpec{"-o,--output", &o.output, "Mesh to write: .ply, .obj, .stl or .glb"}.must()};
}

}  // namespace

void add_lod(CLI::App& app) {
  define_command(app,
                 {"lod", "Take a level of a progressive mesh",
                  "  lodestone lod statue.glb --triangles 5000 -o statue5k.ply\n"
                  "  lodestone lod scan.lpm --error 0.5 -o coarse.obj\n"},
                 declare, run);
}

}  // namespace lodestone
