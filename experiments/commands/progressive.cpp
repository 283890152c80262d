// lodestone progressive: a mesh that any level can be taken from, on one parent index per vertex.
#include "experiments/subjects/progressive.h"

#include <fmt/core.h>

#include <optional>

#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"

namespace lodestone {
namespace {

struct ProgressiveOptions {
  std::string input, output;
  std::optional<std::string> metric;
  InputOptions reading;
  std::uint64_t triangles = 0, base_triangles = 0;
  std::optional<std::uint32_t> position_bits;
  std::uint32_t uv_bits = LpmConfig{}.uv_bits;
  int texture_quality = 0;
  bool no_attributes = false, no_normals = false, compress = false;
  std::uint32_t check_levels = 0;
};

ProgressiveJob job_of(const ProgressiveOptions& options) {
  ProgressiveJob job;
  job.input = options.input;
  job.output = options.output;
  job.reading = read_config(options.reading, {options.input});
  job.reading.attributes = !options.no_attributes;
  job.normals = !options.no_normals;
  if (options.metric) job.metric = progressive::metric_kind(*options.metric);
  job.config.finest_triangles = options.triangles;
  job.config.base_triangles = options.base_triangles;
  job.file.lpm.position_bits = options.position_bits.value_or(LpmConfig{}.position_bits);
  job.file.lpm.uv_bits = options.uv_bits;
  job.file.compress_glb = options.compress;
  job.texture_quality = options.texture_quality;
  job.check_levels = options.check_levels;
  return job;
}

// In units of the model; 0 where nothing has collapsed.
double base_error(const ProgressiveMesh& mesh) {
  return mesh.base_vertices < mesh.vertex_count() ? mesh.errors[mesh.base_vertices] * mesh.transform.scale : 0;
}

Json to_json(const ProgressiveResult& result, const Row& row, const ProgressiveOptions& options) {
  using lodestone::to_json;
  Json json = without_nulls(row);
  json.update({{"input", options.input},
               {"output", options.output},
               {"metric", progressive::name_of(result.metric)},
               {"base_error", base_error(result.mesh)},
               {"collapse_rounds", result.report.rounds},
               {"repairs", to_json(result.repairs)},
               {"warnings", result.warnings}});
  return json;
}

void print(const ProgressiveResult& result, const Row& row, const ProgressiveOptions& options) {
  const auto number = [&](const char* column) { return row.at(column).get<double>(); };
  fmt::print("{}: {} triangles to a base of {} in {:.2f} s, {:.0f} thousand per core-second\n", options.output,
             number("input_triangles"), number("base_triangles"), number("seconds"), number("ktri_per_core_second"));
  fmt::print("{} vertices, {:.2f} bytes each, {:.1f} kB to the first picture\n", number("finest_vertices"),
             number("bytes_per_vertex"), number("base_bytes") / 1000);
  if (!options.metric)
    fmt::print("ranked by {}{}\n", progressive::name_of(result.metric),
               result.metric == progressive::MetricKind::quadric
                   ? ": the file has no attributes that could slide"
                   : ", as the file keeps attributes; --metric quadric is nearer to the surface");
  const double images = number("file_bytes") - number("geometry_bytes");
  if (options.texture_quality == 0 && images > number("geometry_bytes"))
    fmt::print(
        "textures take {:.1f} of {:.1f} MB, as they are; --texture-quality 75 makes them five to fifteen times "
        "smaller\n",
        images / 1e6, number("file_bytes") / 1e6);
  print_up_note(result.mesh.transform.up);
  print_repairs(result.repairs);
  if (result.report.cut_vertices > 0)
    fmt::print("cut apart where it is not a manifold: {} edges, {} vertices copied\n", number("cut_edges"),
               number("cut_vertices"));
  if (result.residual_edges)
    fmt::print("residual edges at {} levels: {}\n", options.check_levels, *result.residual_edges);
  print_warnings(result.warnings);
}

void run(const ProgressiveOptions& options, const CommonOptions& common) {
  ProgressiveJob job = job_of(options);
  const bool lpm = options.output.ends_with(".lpm");
  check_files(common, {{"IN", options.input}}, {{"--output", options.output, lpm ? ".lpm" : ".glb"}});
  Progress progress("reading", common.quiet);
  job.on_phase = [&](const std::string& phase) { progress.phase(phase); };
  const ProgressiveResult result = run(job, *make_scheduler(common));
  progress.clear();
  const Row row = to_row(result);
  write_result(common, to_json(result, row, options));
  if (common.prints()) print(result, row, options);
}

OptionTable declare(ProgressiveOptions& o) {
  return with_input_options(
      {OptionSpec{"IN", &o.input, std::string("Mesh: ") + mesh_formats}.must(),
       OptionSpec{"-o,--output", &o.output,
                  ".glb (every viewer shows it, nothing is lost) or .lpm (small, quantized, draws while it loads)"}
           .must(),
       {"--metric", &o.metric,
        "quadric: geometry alone, nearest to the surface; attribute-quadric: with normals, colours and texture "
        "coordinates, which stay in place; parametric: the largest distance between points of equal texture "
        "coordinates. "
        "Default: attribute-quadric if the file keeps any of these (.lpm has no normals), else quadric"},
       {"--triangles", &o.triangles, "Triangles of the finest level, at most; 0: all of the mesh"},
       {"--base", &o.base_triangles, "Triangles to stop at; 0: when nothing can collapse"},
       OptionSpec{"--position-bits", &o.position_bits,
                  ".lpm: 2 to this power steps over the model. Not given: 12, or up to 16 so that a step is no longer "
                  "than the error of the level of half the vertices"}
           .between(4, 20),
       OptionSpec{"--uv-bits", &o.uv_bits, ".lpm: the same over the texture coordinates"}.between(4, 20),
       {"--compress", &o.compress, ".glb: by EXT_meshopt_compression, without loss"},
       OptionSpec{"--texture-quality", &o.texture_quality,
                  "Encode textures again where that is smaller: as WebP of this quality, with alpha as it is; data of "
                  "several channels, and normals that WebP would blur, as JPEG of full chroma resolution. At 50 the "
                  "textures of scans are about a fifteenth, and look the same. Not given: they remain as they are"}
           .between(1, 100),
       {"--no-attributes", &o.no_attributes, "Leave out what the mesh has besides its shape"},
       {"--no-normals", &o.no_normals,
        "Leave out its normals, which make every edge a seam where faces are shaded flat"},
       up_option(o.reading.up),
       OptionSpec{"--check-levels", &o.check_levels, "Number of levels at which cracks (residual edges) are counted"}
           .between(0, 1000)},
      o.reading);
}

}  // namespace

void add_progressive(CommandTable& commands) {
  define_command<ProgressiveOptions>(
      commands,
      {"progressive", "Make a progressive mesh: any level by vertices, triangles or error",
       "  lodestone progressive scan.ply -o scan.lpm\n"
       "  lodestone progressive statue.obj -o statue.glb --metric attribute-quadric --base 2000\n"},
      declare, run);
}

}  // namespace lodestone
