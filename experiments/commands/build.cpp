// lodestone build: a mesh file in, a .lode file out.
#include "experiments/subjects/build.h"

#include <fmt/core.h>

#include "core/base/error.h"
#include "core/mesh/up_axis.h"
#include "experiments/command_line/progress.h"
#include "experiments/command_line/trace_file.h"
#include "experiments/commands/build_notes.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"

namespace lodestone {
namespace {

struct BuildOptions {
  std::vector<std::string> inputs;
  std::string output, scratch, trace;
  InputOptions reading;
  Bytes memory_limit;
  float sigma0 = BuildConfig{}.sigma0;
  double refine_limit = BuildConfig{}.refine_limit;
  std::uint32_t cell_triangles = BuildConfig{}.cell_triangles;
  std::optional<int> levels, lattice_bits;
  std::string simplifier = "quadric", strategy = "graph";
  std::optional<std::string> placement;
  bool half_levels = false, no_attributes = false, compress = false, refine = false, measure = false,
       texture_levels = false, resume = false;
};

BuildConfig build_config(const BuildOptions& options) {
  BuildConfig config;
  config.sigma0 = options.sigma0;
  config.cell_triangles = options.cell_triangles;
  config.finest_level = options.levels.value_or(-1);
  config.half_levels = options.half_levels;
  config.simplifier = options.simplifier;
  if (options.placement) config.placement = placement_named(*options.placement);
  config.strategy = strategy_named(options.strategy);
  config.refine = options.refine;
  config.refine_limit = options.refine_limit;
  config.order_cells = options.compress;
  return config;
}

BuildJob job_of(const BuildOptions& options) {
  BuildJob job;
  job.inputs.assign(options.inputs.begin(), options.inputs.end());
  job.output = options.output;
  job.reading = read_config(options.reading, options.inputs);
  job.reading.attributes = !options.no_attributes;
  job.build = build_config(options);
  job.lattice = {options.lattice_bits.value_or(options.compress ? Lattice::automatic : 0)};
  job.form = options.compress ? LodeForm::compressed : LodeForm::plain;
  job.measure_errors = options.measure;
  job.texture_levels = options.texture_levels;
  job.memory_limit = options.memory_limit.count;
  job.scratch = options.scratch;
  job.resume = options.resume;
  return job;
}

void report_to(Progress& progress, BuildJob& job, const CommonOptions& common) {
  job.build.progress = [&](double share) { progress.update(share); };
  job.on_phase = [&](const std::string& phase, double triangles) {
    progress.phase(phase);
    if (triangles > 0) progress.measure(triangles, "triangles");
  };
  job.on_scratch = [&](const ScratchUse& scratch) {
    if (!common.prints()) return;
    fmt::print("temporary files: about {:.1f} MB in {}{}\n", static_cast<double>(scratch.expected_bytes) * 1e-6,
               scratch.folder, scratch.kept ? ", kept until the build is done" : "");
    std::fflush(stdout);
  };
}

// The row, and what a person or a script may want to know besides.
Json to_json(const BuildResult& result, const Row& row, const BuildOptions& options, int threads) {
  using lodestone::to_json;
  const Hierarchy& hierarchy = result.hierarchy;
  const Lattice lattice = hierarchy.transform.lattice;
  const RefineReport& refined = result.report.refinement;
  Json stages;
  for (const auto& [name, time] : result.stages) stages[name] = to_json(time);
  Json json = without_nulls(row);
  json.update({{"inputs", options.inputs},
               {"level_table", level_table(hierarchy)},
               {"compressed", options.compress},
               {"lattice_bits", lattice.bits},
               {"lattice_error", lattice.error() * hierarchy.transform.scale},
               {"sigma0", hierarchy.sigma0},
               {"half_levels", hierarchy.grids.halves},
               {"refined",
                {{"split_triangles", refined.split},
                 {"triangles_before", refined.triangles_before},
                 {"triangles_after", refined.triangles_after}}},
               {"up", name_of(hierarchy.transform.up.axis)},
               {"up_guessed", hierarchy.transform.up.guessed},
               {"errors", options.measure ? "measured" : "estimated"},
               {"stages", stages},
               {"threads", threads},
               {"strategy", options.strategy},
               {"simplifier", options.simplifier},
               {"placement", name_of(static_cast<Placement>(hierarchy.provenance.placement))},
               {"attributes", to_json(result.attributes)},
               {"texture_copies", hierarchy.texture_copies.size()},
               {"warnings", result.warnings},
               {"repairs", to_json(hierarchy.provenance.repairs)}});
  if (const auto& scratch = result.scratch)
    json.update({{"memory_limit", options.memory_limit.count},
                 {"scratch",
                  {{"folder", scratch->folder},
                   {"expected_bytes", scratch->expected_bytes},
                   {"blocks", scratch->blocks},
                   {"blocks_resumed", scratch->blocks_resumed}}}});
  if (const auto& measured = result.measured) json["error_excess"] = measured->excess;
  if (!options.trace.empty()) json["trace"] = options.trace;
  return json;
}

void print(const BuildResult& result, const Row& row, const BuildOptions& options) {
  const auto number = [&](const char* column) { return row.at(column).get<double>(); };
  const Hierarchy& hierarchy = result.hierarchy;
  fmt::print("{}: {} triangles -> {} levels, {} cells, {} triangles stored ({:.3f} of the input)\n", options.output,
             number("input_triangles"), number("levels"), number("cells"), number("stored_triangles"),
             number("stored_ratio"));
  if (options.refine)
    fmt::print("refined: {} of {} triangles had an edge longer than sigma0 h_L; {} triangles now\n",
               result.report.refinement.split, result.report.refinement.triangles_before,
               result.report.refinement.triangles_after);
  fmt::print("{:.1f} MB, {:.2f} bytes per stored triangle\n", number("file_bytes") * 1e-6,
             number("bytes_per_stored_triangle"));
  if (const Lattice lattice = hierarchy.transform.lattice)
    fmt::print("on a lattice of {} bits: vertices of the input move by at most {:.3g}\n", lattice.bits,
               lattice.error() * hierarchy.transform.scale);
  fmt::print("{:.2f} s, {:.2f} CPU s, {:.0f} MB peak, {:.2f} M triangles per core-second\n", number("file_seconds"),
             number("file_cpu_seconds"), number("peak_bytes") * 1e-6, number("mtri_per_core_second"));
  if (hierarchy.finest() > 0) fmt::print("errors {}\n", nature_of_errors(hierarchy));
  // A number of levels asked for may be too large for the model; one chosen by the program is not.
  print_build_notes(result, options.levels ? 0 : number("stored_ratio"));
}

void run(const BuildOptions& options, const CommonOptions& common) {
  if (options.resume)
    set_interrupt_line("lodestone: interrupted; --resume continues from the temporary files that were kept\n");
  std::vector<FileArgument> outputs{{"--output", options.output, ".lode"}};
  if (!options.trace.empty()) outputs.push_back({"--trace", options.trace});
  check_files(common, file_arguments("IN", options.inputs), outputs);
  BuildJob job = job_of(options);
  auto scheduler = make_scheduler(common);
  if (!options.trace.empty()) {
    job.trace = std::make_shared<Trace>(scheduler->workers());
    scheduler = make_tracing_scheduler(std::move(scheduler), job.trace);
  }
  Progress progress("building", common.quiet);
  report_to(progress, job, common);
  const BuildResult result = run(job, *scheduler);
  progress.clear();
  if (job.trace) write_trace(*job.trace, options.trace);
  const Row row = to_row(result);
  write_result(common, to_json(result, row, options, scheduler->workers()));
  if (common.prints()) print(result, row, options);
}

OptionTable declare(BuildOptions& o) {
  return with_input_options(
      {OptionSpec{"IN", &o.inputs, std::string("Mesh, in one file or several: ") + mesh_formats}.must(),
       OptionSpec{"-o,--output", &o.output, "Hierarchy to write (.lode)"}.must(),
       up_option(o.reading.up),
       {"--no-attributes", &o.no_attributes, "Leave out what the mesh has besides its shape"},
       {"--sigma0", &o.sigma0, "Displacement bound: a vertex of level l moves at most sigma0 h_l / 2 to its parent"},
       OptionSpec{"--cell-triangles", &o.cell_triangles,
                  "Mean triangles per occupied finest cell, from which the number of levels follows"}
           .between(1, 1e9),
       OptionSpec{"--levels", &o.levels, "Finest level L instead (the root is level 0)"}.between(0, max_level),
       {"--half-levels", &o.half_levels,
        "Levels of a half of the triangles instead of a quarter: fewer triangles draw the same picture, of a file half "
        "as large again; best with --cell-triangles 600"},
       {"--compress", &o.compress,
        "Compress the file; vertices are put on one lattice, as by --lattice, and cells are reordered"},
       OptionSpec{"--lattice", &o.lattice_bits,
                  "Put the vertices of all levels on multiples of 2^-BITS of the longest extent; with --compress the "
                  "default is chosen from the lengths of the edges"}
           .between(1, Lattice::most_bits)
           .of_type("BITS"),
       {"--texture-levels", &o.texture_levels,
        "Store copies of the textures for coarser levels, each half the width and height of the next finer level's "
        "down to 32 pixels a side; of PNG, JPEG and WebP"},
       {"--simplifier", &o.simplifier,
        "quadric, cluster (fast and coarse), openmesh (its decimater: the reference, slow) or meshopt (the peer); all "
        "keep the bound, locks, borders and, except for cluster, the topology"},
       {"--placement", &o.placement,
        "Place of the vertices that remain: optimal (moved once to where their quadric is least; quadric alone, its "
        "default) or endpoint (where they are)"},
       {"--refine", &o.refine,
        "Split edges of the input longer than sigma0 h_L, both sides alike, so that the reach keeps its bound: for CAD "
        "models and filled holes; without it they are counted, and cost triangles when drawing"},
       OptionSpec{
           "--refine-limit", &o.refine_limit,
           "Triangles that --refine may make, as a multiple of the input's; always 100,000. Levels are chosen so "
           "that this is enough"}
           .between(1, 1e6)
           .only_with({"--refine"}),
       {"--measure-error", &o.measure,
        "Measure how far cells are from the finest mesh, every point both ways, instead of estimating it while "
        "building: bounds that hold, at most 5 % or 1e-5 h too large (more on some surfaces full of needles, as a note "
        "then says); takes longer than the build"},
       {"--strategy", &o.strategy, "graph, levels or serial; all give the same bytes"},
       {"--memory-limit", &o.memory_limit,
        "Memory that may be resident, such as 2GiB or 1500MB: a mesh that needs more is built out of core, to the same "
        "bytes, from binary PLY without attributes or binary STL"},
       OptionSpec{"--scratch", &o.scratch, "Folder for temporary files; default: that of the output"}
           .only_with({"--memory-limit"})
           .of_type("DIR"),
       OptionSpec{"--resume", &o.resume,
                  "Keep the temporary files of an interrupted or failed build, as OUT.scratch in that folder, and "
                  "continue from those that are there; without it they are gone however the build ends"}
           .only_with({"--memory-limit"}),
       {"--trace", &o.trace,
        "File for what each worker did when: JSON for chrome://tracing or ui.perfetto.dev (.json)"}},
      o.reading);
}

}  // namespace

void add_build(CommandTable& commands) {
  define_command<BuildOptions>(
      commands,
      {"build", "Build the hierarchical level of detail of a mesh",
       "  lodestone build scan.ply -o scan.lode\n"
       "  lodestone build scan.obj -o scan.lode --cell-triangles 1500 --json build.json\n"
       "  lodestone build city/tileset.json -o city.lode --texture-levels\n"
       "  lodestone build scans/part*.ply -o whole.lode\n"
       "  lodestone build statue.ply -o statue.lode --memory-limit 2GiB --scratch /mnt/fast --resume\n"
       "  lodestone build alps.raw --grid 1197x643:i16:30 --fill-voids -o alps.lode\n"},
      declare, run);
}

}  // namespace lodestone
