// lodestone lod: a level of a progressive mesh as a mesh file.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/progressive/mesh/level.h"
#include "core/progressive/progressive_file.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "parallel/progressive/level_errors.h"
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

std::uint32_t choose(const LodOptions& options, const LevelFinder& levels, const LevelErrors& errors,
                     const ProgressiveMesh& mesh) {
  if (options.vertices) return levels.vertices_for(*options.vertices);
  if (options.triangles) return levels.vertices_for_triangles(*options.triangles);
  if (const double finest = mesh.finest_error * mesh.transform.scale; *options.error < finest)
    throw InputError(
        describe(options.input, "",
                 fmt::format("no level is within {:g} of the input: the finest is within {:g}", *options.error, finest),
                 "make it anew, as a .glb or with more --position-bits and --triangles"));
  return errors.vertices_for(*options.error / mesh.transform.scale);
}

void run(const LodOptions& options, const CommonOptions& common) {
  if (!options.vertices && !options.triangles && !options.error)
    throw UsageError("--vertices, --triangles or --error is required; see lodestone lod --help");
  check_files(common, {{"IN", options.input}}, {{"--output", options.output}});
  const ProgressiveMesh mesh = load_progressive(options.input, options.prefix);
  if (mesh.triangles.empty()) throw InputError(describe(options.input, "", "the model has no triangles"));
  const LevelFinder levels(mesh);
  const auto scheduler = make_scheduler(common);
  const LevelErrors errors(mesh, levels, *scheduler);
  const CpuClock clock;
  const std::uint32_t vertices = choose(options, levels, errors, mesh);
  const RawMesh raw = levels.level_mesh(vertices);
  const StageTime time = clock.elapsed();
  if (raw.triangles.empty())
    throw InputError(describe(options.input, "", "the level has no triangles", "ask for a finer one"));
  const std::vector<std::string> warnings = write_mesh(options.output, raw);
  // Both are bounds.
  const double error = std::min(errors.error_of(vertices) * mesh.transform.scale, options.error.value_or(HUGE_VAL));
  write_result(common, {{"input", options.input},
                        {"output", options.output},
                        {"vertices", vertices},
                        {"triangles", raw.triangles.size()},
                        {"error", error},
                        {"estimate", levels.error_of(vertices) * mesh.transform.scale},
                        {"level", to_json(time)},
                        {"finest_vertices", mesh.vertex_count()},
                        {"finest_triangles", mesh.triangles.size()},
                        {"base_vertices", mesh.base_vertices},
                        {"warnings", warnings}});
  if (!common.prints()) return;
  fmt::print("{}: {} triangles, {} vertices of {}, at most {:g} from the input{}\n", options.output,
             raw.triangles.size(), vertices, mesh.vertex_count(), error,
             options.prefix ? " (estimated for a part of the file)" : "");
  print_warnings(warnings);
}

OptionTable declare(LodOptions& o) {
  return {
      OptionSpec{"IN", &o.input, "Progressive mesh (.lpm or .glb of `lodestone progressive`)"}.must(),
      {"--vertices", &o.vertices, "Maximum number of vertices"},
      OptionSpec{"--triangles", &o.triangles, "Maximum number of triangles"}.not_with({"--vertices"}),
      OptionSpec{"--error", &o.error,
                 "A level no point of which is farther than this from the input, nor the input from it, in units of "
                 "the model: measured, quantization included, whatever the metric; about the coarsest"}
          .at_least(0)
          .not_with({"--vertices", "--triangles"}),
      {"--prefix", &o.prefix, "Accept an .lpm that ends early: the part of it that is there"},
      OptionSpec{"-o,--output", &o.output, "Mesh to write: .ply, .obj, .stl or .glb"}.must()};
}

}  // namespace

void add_lod(CommandTable& commands) {
  define_command<LodOptions>(commands,
                             {"lod", "Take a level of a progressive mesh",
                              "  lodestone lod statue.glb --triangles 5000 -o statue5k.ply\n"
                              "  lodestone lod scan.lpm --error 0.5 -o coarse.obj\n"},
                             declare, run);
}

}  // namespace lodestone
