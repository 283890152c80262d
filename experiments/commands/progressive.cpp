// lodestone progressive: a mesh that any level can be taken from, on one parent index per vertex.
#include <fmt/core.h>

#include "core/base/error.h"
#include "core/progressive/mesh/level.h"
#include "core/progressive/progressive_file.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/metrics/cracks/progressive_cracks.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/load.h"
#include "parallel/progressive/make_progressive.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

struct ProgressiveOptions {
  std::string input, output, metric = "quadric";
  InputOptions reading;
  ProgressiveConfig config;
  ProgressiveFileConfig file;
  bool no_attributes = false, no_normals = false;
  std::uint32_t check_levels = 0;
};

// By kilobytes of geometry, so that textures do not hide what vertices cost.
double per_vertex(std::size_t bytes, const ProgressiveMesh& mesh) {
  return static_cast<double>(bytes) / static_cast<double>(mesh.positions.size());
}

RawMesh read(const ProgressiveOptions& options, Scheduler& scheduler) {
  ReadConfig reading = read_config(options.reading, {options.input});
  reading.attributes = !options.no_attributes;
  RawMesh raw = load_mesh(options.input, scheduler, reading);
  if (options.no_normals) raw.wedges.normal.clear();
  return raw;
}

void run(const ProgressiveOptions& options, const CommonOptions& common) {
  ProgressiveConfig config = options.config;
  config.metric = progressive::metric_kind(options.metric);
  const bool lpm = options.output.ends_with(".lpm");
  check_files(common, {{"IN", options.input}}, {{"--output", options.output, lpm ? ".lpm" : ".glb"}});
  const auto scheduler = make_scheduler(common);
  Progress progress("reading", common.quiet);
  progress.phase("reading");
  RawMesh raw = read(options, *scheduler);
  const std::vector<std::string> warnings = std::move(raw.warnings);
  Repairs repairs;
  IndexedMesh mesh = prepare_mesh(std::move(raw), repairs, *scheduler, options.input);
  check_interrupt();
  progress.phase("collapsing");
  const CpuClock clock;
  ProgressiveReport report;
  const ProgressiveMesh made = make_progressive(std::move(mesh), config, *scheduler, report);
  const StageTime time = clock.elapsed();
  check_interrupt();
  progress.phase("writing");
  const ProgressiveFileSize size = save_progressive(made, options.output, options.file);
  progress.clear();
  const auto faces = static_cast<double>(made.triangles.size());
  const LevelFinder levels(made);
  nlohmann::json cracks;
  if (options.check_levels > 0) cracks = residual_edges_of_levels(made, options.check_levels);
  write_json(common, {{"input", options.input},
                      {"output", options.output},
                      {"residual_edges", cracks},
                      {"metric", options.metric},
                      {"triangles", made.triangles.size()},
                      {"vertices", made.vertex_count()},
                      {"base_triangles", levels.triangles_of(made.base_vertices)},
                      {"base_vertices", made.base_vertices},
                      {"base_error", levels.error_of(made.base_vertices) * made.transform.scale},
                      {"cut_vertices", report.cut_vertices},
                      {"cut_edges", report.cut_edges},
                      {"rounds", report.rounds},
                      {"repairs", to_json(repairs)},
                      {"warnings", warnings},
                      {"collapse", to_json(time)},
                      {"faces_per_cpu_second", faces / std::max(time.cpu_seconds, 1e-9)},
                      {"bytes", size.bytes},
                      {"geometry_bytes", size.geometry},
                      {"base_bytes", size.base},
                      {"bytes_per_vertex", per_vertex(size.geometry, made)},
                      {"peak_bytes", peak_resident_bytes()}});
  if (common.quiet || common.json == "-") return;
  fmt::print("{}: {} triangles to a base of {} in {:.2f} s, {:.0f} thousand per core-second\n", options.output,
             made.triangles.size(), levels.triangles_of(made.base_vertices), time.seconds,
             faces / std::max(time.cpu_seconds, 1e-9) / 1000);
  fmt::print("{} vertices, {:.2f} bytes each, {:.1f} kB to the first picture\n", made.vertex_count(),
             per_vertex(size.geometry, made), static_cast<double>(size.base) / 1000);
  print_repairs(repairs);
  if (report.cut_vertices > 0)
    fmt::print("cut apart where it is no manifold: {} edges, {} vertices copied\n", report.cut_edges,
               report.cut_vertices);
  if (options.check_levels > 0) fmt::print("residual edges at {} levels: {}\n", options.check_levels, cracks.dump());
  print_warnings(warnings);
}

}  // namespace

void add_progressive(CLI::App& app) {
  const auto common = std::make_shared<CommonOptions>();
  const auto options = std::make_shared<ProgressiveOptions>();
  CLI::App& command =
      add_command(app, "progressive", "Make a progressive mesh: any level by vertices, triangles or error",
                  "  lodestone progressive scan.ply -o scan.lpm\n"
                  "  lodestone progressive statue.obj -o statue.glb --metric attribute-quadric --base 2000\n",
                  common);
  command.add_option("IN", options->input, std::string("Mesh: ") + mesh_formats)->required();
  command
      .add_option("-o,--output", options->output,
                  ".glb (every viewer shows it, nothing is lost) or .lpm (small, quantized, draws while it loads)")
      ->required();
  command
      .add_option("--metric", options->metric,
                  "quadric: geometry alone; attribute-quadric: with normals, colours and texture coordinates; "
                  "parametric: the largest distance between points of equal texture coordinates")
      ->capture_default_str();
  command.add_option("--base", options->config.base_triangles, "Triangles to stop at; 0: when nothing can collapse")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_option("--position-bits", options->file.lpm.position_bits, ".lpm: steps over the model are 2 to so many")
      ->check(CLI::Range(4, 20))
      ->capture_default_str();
  command.add_option("--uv-bits", options->file.lpm.uv_bits, ".lpm: the same over the texture coordinates")
      ->check(CLI::Range(4, 20))
      ->capture_default_str();
  command.add_flag("--compress", options->file.compress_glb, ".glb: by EXT_meshopt_compression, without loss");
  command.add_flag("--no-attributes", options->no_attributes, "Leave out what the mesh has besides its shape");
  command.add_flag("--no-normals", options->no_normals,
                   "Leave out its normals, which make every edge a seam where faces are shaded flat");
  command.add_option("--check-levels", options->check_levels, "Count cracks (residual edges) at so many levels")
      ->check(CLI::Range(0, 1000));
  add_input_options(command, options->reading);
  command.callback([options, common] { run(*options, *common); });
}

}  // namespace lodestone
