// lodestone build: a mesh file in, a .lode file out.
#include "parallel/build/build.h"

#include <fmt/core.h>

#include "core/base/error.h"
#include "experiments/command_line/progress.h"
#include "experiments/command_line/trace_file.h"
#include "experiments/command_line/version.h"
#include "experiments/commands/build_limit.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "experiments/metrics/cost/cost.h"
#include "parallel/out_of_core/build_model.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

// Stored triangles over those of the input: 4/3 for a surface that simplifies everywhere. Worth a word from here on.
constexpr double much_stored = 1.6;

struct BuildOptions {
  std::string input, output, trace;
  InputOptions reading;
  LimitOptions limit;
  bool no_attributes = false;
  std::string simplifier = "quadric", placement, strategy_name = "graph";
  bool compress = false, measure = false, texture_levels = false;
  int lattice_bits = 0;  // 0: none, or automatic when the file is compressed
  BuildConfig config;
};

struct Totals {
  std::uint64_t triangles = 0, vertices = 0, long_edges = 0;
};

Totals totals(const Hierarchy& h) {
  Totals t;
  for (const Level& level : h.levels) t.triangles += level.triangles, t.vertices += level.vertices;
  t.long_edges = h.levels.back().long_edges;
  return t;
}

nlohmann::json level_ratios(const Hierarchy& h) {
  nlohmann::json euclidean, chebyshev, diameter, error, triangles;
  for (const Level& level : h.levels) {
    euclidean.push_back(level.reach[0]);
    chebyshev.push_back(level.reach[1]);
    diameter.push_back(level.diameter);
    error.push_back(level.error);
    triangles.push_back(level.triangles);
  }
  return {{"reach", {{"euclidean", euclidean}, {"chebyshev", chebyshev}}},
          {"diameter", diameter},
          {"error_ratio", error},
          {"level_triangles", triangles}};
}

nlohmann::json to_json(const RefineReport& report) {
  return {{"split_triangles", report.split},
          {"triangles_before", report.triangles_before},
          {"triangles_after", report.triangles_after}};
}

Lattice lattice_of(const BuildOptions& options) {
  if (options.compress && options.lattice_bits == 0) return {Lattice::automatic};
  return {options.lattice_bits};
}

nlohmann::json to_json(const AttributeCounts& counts) {
  return {{"wedges", counts.wedges},       {"normals", counts.normals},
          {"colours", counts.colours},     {"texture_coordinates", counts.texture_coordinates},
          {"materials", counts.materials}, {"textures", counts.textures}};
}

ModelConfig model_config(const BuildOptions& options) {
  ModelConfig config;
  config.build = options.config;
  config.build.simplifier = simplifier_kind(options.simplifier);
  if (!options.placement.empty()) config.build.placement = placement(options.placement);
  config.build.strategy = strategy(options.strategy_name);
  config.build.order_cells = options.compress;
  config.output = options.output;
  config.lattice = lattice_of(options);
  config.form = options.compress ? LodeForm::compressed : LodeForm::plain;
  config.measure_errors = options.measure;
  config.texture_copies = options.texture_levels;
  config.memory_limit = options.limit.memory_limit;
  config.scratch = options.limit.scratch;
  config.resume = options.limit.resume;
  config.program = std::string(program_version());
  return config;
}

// What needs all of the mesh or of the hierarchy at once.
void refuse_beyond_limit(const BuildOptions& options) {
  for (const auto& [given, name] : {std::pair{options.measure, "--measure-error"}, {options.config.refine, "--refine"}})
    if (given)
      throw InputError(describe(options.input, "", std::string(name) + " needs more memory than --memory-limit allows",
                                "leave one of them out"));
}

void run(const BuildOptions& options, const CommonOptions& common) {
  std::vector<FileArgument> outputs{{"--output", options.output, ".lode"}};
  if (!options.trace.empty()) outputs.push_back({"--trace", options.trace});
  check_files(common, {{"IN", options.input}}, outputs);
  ReadConfig reading = read_config(options.reading, {options.input});
  reading.attributes = !options.no_attributes;
  ModelConfig config = model_config(options);
  const ModelSource source = open_model_source(options.input, reading, config.memory_limit);
  if (source.stream) refuse_beyond_limit(options);
  auto scheduler = make_scheduler(common);
  const auto trace = std::make_shared<Trace>(scheduler->workers());
  if (!options.trace.empty()) scheduler = make_tracing_scheduler(std::move(scheduler), trace);
  Progress progress("building", common.quiet);
  const bool say = !common.quiet && common.json != "-";
  if (source.stream && config.resume)
    set_interrupt_line("lodestone: interrupted; --resume continues from the temporary files, which were kept\n");
  TraceSummary use;  // of the workers, while building
  config.progress = [&, step = std::string(), begin = 0.0](const ModelProgress& now) mutable {
    if (step.empty() && source.stream && say)
      print_scratch(config, model_need(*source.stream, config, scheduler->workers()));
    if (step != now.step) {
      if (step == "building") use = summarize(*trace, begin);
      begin = source.stream ? 0 : trace->now();
      progress.phase(step = now.step);
      if (now.triangles > 0) progress.measure(static_cast<double>(now.triangles), "triangles");
    }
    progress.update(now.share);
  };

  const CpuClock all;
  const ModelResult built = build_model(source, config, *scheduler);
  progress.clear();
  const StageTime time = all.elapsed();
  nlohmann::json stages;
  for (const auto& [name, t] : built.report.stages) stages[name] = to_json(t);
  const Hierarchy& hierarchy = built.hierarchy;
  const Repairs& repairs = hierarchy.provenance.repairs;
  const std::uint64_t file_bytes = built.file_bytes;

  const Totals sum = totals(hierarchy);
  const auto input = static_cast<double>(hierarchy.provenance.input_triangles);
  const Lattice lattice = hierarchy.transform.lattice;
  // Of building, reading and writing apart, in core and out of it.
  const double rate = input * 1e-6 / std::max(built.report.total.cpu_seconds, 1e-9);
  nlohmann::json result = level_ratios(hierarchy);
  result.update({{"input", options.input},
                 {"input_triangles", hierarchy.provenance.input_triangles},
                 {"input_vertices", hierarchy.provenance.input_vertices},
                 {"stored_triangles", sum.triangles},
                 {"stored_vertices", sum.vertices},
                 {"stored_triangle_ratio", static_cast<double>(sum.triangles) / input},
                 {"stored_vertex_ratio",
                  static_cast<double>(sum.vertices) / static_cast<double>(hierarchy.provenance.input_vertices)},
                 {"file_bytes", file_bytes},
                 {"bytes_per_stored_triangle", static_cast<double>(file_bytes) / static_cast<double>(sum.triangles)},
                 {"compressed", options.compress},
                 {"lattice_bits", lattice.bits},
                 {"lattice_error", lattice.error() * hierarchy.transform.scale},
                 {"levels", hierarchy.levels.size()},
                 {"cells", hierarchy.cells.size()},
                 {"sigma0", hierarchy.sigma0},
                 {"long_edges", sum.long_edges},
                 {"max_edge_ratio", hierarchy.levels.back().max_edge},
                 {"refined", to_json(built.report.refinement)},
                 {"errors", options.measure ? "measured" : "estimated"},
                 {"seconds", time.seconds},
                 {"cpu_seconds", time.cpu_seconds},
                 {"peak_bytes", peak_resident_bytes()},
                 {"stages", stages},
                 {"mtri_per_core_second", rate},
                 {"threads", scheduler->workers()},
                 {"strategy", options.strategy_name},
                 {"simplifier", options.simplifier},
                 {"placement", name_of(static_cast<Placement>(hierarchy.provenance.placement))},
                 {"attributes", to_json(built.attributes)},
                 {"texture_copies", hierarchy.texture_copies.size()},
                 {"warnings", built.warnings},
                 {"repairs", to_json(repairs)}});
  if (source.stream)
    result.update(scratch_results(config, model_need(*source.stream, config, scheduler->workers()), built));
  if (!options.trace.empty()) {
    write_trace(*trace, options.trace);
    result["trace"] = {
        {"file", options.trace}, {"build_busy", use.busy}, {"build_idle_tail", use.idle_tail}};
  }
  write_json(common, result);
  if (!say) return;
  fmt::print("{}: {} triangles -> {} levels, {} cells, {} triangles stored ({:.3f} of the input)\n", options.output,
             hierarchy.provenance.input_triangles, hierarchy.levels.size(), hierarchy.cells.size(), sum.triangles,
             static_cast<double>(sum.triangles) / input);
  if (config.build.refine)
    fmt::print("refined: {} of {} triangles had an edge longer than sigma0 h_L; {} triangles now\n",
               built.report.refinement.split, built.report.refinement.triangles_before,
               built.report.refinement.triangles_after);
  fmt::print("{:.1f} MB, {:.2f} bytes per stored triangle\n", static_cast<double>(file_bytes) * 1e-6,
             static_cast<double>(file_bytes) / static_cast<double>(sum.triangles));
  if (lattice)
    fmt::print("on a lattice of {} bits: vertices of the input move by at most {:.3g}\n", lattice.bits,
               lattice.error() * hierarchy.transform.scale);
  fmt::print("{:.2f} s, {:.2f} CPU s, {:.0f} MB peak, {:.2f} M triangles per core-second\n", time.seconds,
             time.cpu_seconds, static_cast<double>(peak_resident_bytes()) * 1e-6, rate);
  print_warnings(built.warnings);
  print_repairs(repairs);
  if (sum.long_edges > 0)
    fmt::print(
        "note: {} half-edges of the input are longer than sigma0 h_L, the longest {:.1f} h_L; they cost triangles, not "
        "correctness: --refine splits them\n",
        sum.long_edges, hierarchy.levels.back().max_edge);
  // A number of levels asked for may be too large for the model; one chosen here is not.
  if (config.build.finest_level < 0 && static_cast<double>(sum.triangles) > much_stored * input)
    fmt::print(
        "note: little of this surface simplifies; `lodestone info {}` counts the edges that are kept as they are\n",
        options.input);
}

}  // namespace

void add_build(CLI::App& app) {
  const auto common = std::make_shared<CommonOptions>();
  const auto options = std::make_shared<BuildOptions>();
  CLI::App& command =
      add_command(app, "build", "Build the hierarchical level of detail of a mesh",
                  "  lodestone build scan.ply -o scan.lode\n"
                  "  lodestone build scan.obj -o scan.lode --cell-triangles 1500 --json build.json\n"
                  "  lodestone build city/tileset.json -o city.lode --texture-levels\n"
                  "  lodestone build statue.ply -o statue.lode --memory-limit 2GiB --scratch /mnt/fast --resume\n"
                  "  lodestone build alps.raw --grid 1197x643:i16:30 --fill-voids -o alps.lode\n",
                  common);
  command.add_option("IN", options->input, std::string("Mesh: ") + mesh_formats)->required();
  add_input_options(command, options->reading);
  command.add_flag("--no-attributes", options->no_attributes, "Leave out what the mesh has besides its shape");
  command.add_option("-o,--output", options->output, "Hierarchy to write (.lode)")->required();
  command
      .add_option("--sigma0", options->config.sigma0,
                  "Displacement bound: a vertex of level l moves at most sigma0 h_l / 2 to its parent")
      ->capture_default_str();
  command
      .add_option("--cell-triangles", options->config.cell_triangles,
                  "Mean triangles per occupied finest cell that the number of levels follows from")
      ->check(CLI::Range(1, 1'000'000'000))
      ->capture_default_str();
  command.add_option("--levels", options->config.finest_level, "Finest level L instead (the root is level 0)")
      ->check(CLI::Range(0, max_level));
  command.add_flag("--compress", options->compress,
                   "Compress the file; vertices are put on one lattice, as by --lattice, and cells are reordered");
  command
      .add_option("--lattice", options->lattice_bits,
                  "Put the vertices of all levels on multiples of 2^-BITS of the longest extent; with --compress the "
                  "default is chosen from the lengths of the edges")
      ->check(CLI::Range(1, Lattice::most_bits))
      ->type_name("BITS");
  command.add_flag("--texture-levels", options->texture_levels,
                   "Store copies of the textures for coarser levels, each half the width and height of the next finer "
                   "level's down to 32 pixels a side; of PNG and JPEG");
  command
      .add_option("--simplifier", options->simplifier,
                  "quadric, cluster (fast and coarse), openmesh (its decimater: the reference, slow) or meshopt (the "
                  "peer); all keep the bound, locks, borders and, but for cluster, the topology")
      ->capture_default_str();
  command.add_option("--placement", options->placement,
                     "Of the vertices that stay: optimal (moved once to where their quadric is least; quadric alone, "
                     "its default) or endpoint (where they are)");
  command.add_flag(
      "--refine", options->config.refine,
      "Split edges of the input longer than sigma0 h_L, both sides alike, so that the reach keeps its bound: "
      "for CAD models and filled holes; without it they are counted, and cost triangles when drawing");
  command.add_flag(
      "--measure-error", options->measure,
      "Measure how far cells are from the finest mesh, every point both ways, instead of estimating it while "
      "building: bounds that hold, at most 5 % too large; takes longer than the build");
  command.add_option("--strategy", options->strategy_name, "graph, levels or serial; all give the same bytes")
      ->capture_default_str();
  add_limit_options(command, options->limit);
  command.add_option("--trace", options->trace,
                     "File for what each worker did when: JSON for chrome://tracing or ui.perfetto.dev (.json)");
  command.callback([options, common] { run(*options, *common); });
}

}  // namespace lodestone
