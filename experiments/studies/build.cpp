// Experiment `build`: what making a hierarchy costs, and how good the levels are.
#include "parallel/build/build.h"

#include <filesystem>

#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/verify/verify.h"
#include "core/mesh/raw_mesh.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/studies/catalogue.h"
#include "experiments/studies/geometry_columns.h"
#include "experiments/studies/result_hash.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/row_verdict.h"
#include "experiments/studies/study_input.h"
#include "parallel/build/measure_errors.h"
#include "parallel/build/save.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/trace.h"
#include "render/lod/radii.h"

namespace lodestone {
namespace {

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{threads_parameter(), rounds_parameter(3)};
  append(list, in_core_build_parameters());
  list.push_back({"compress", false, "", "the file is a compressed one, its vertices on a lattice", 0, 0, {}});
  list.push_back({"error_level", 2, "", "levels above the finest whose mesh is held against the input", 0, 20, {}});
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  const ColumnNeed measured{{{"measure_error", true}}};
  std::vector<ColumnInfo> list{
      {"triangles", "", "of the input", count},
      {"vertices", "", "of the input", count},
      {"levels", "", "of the hierarchy", count},
      {"cells", "", "of the hierarchy", count},
      {"stored_triangles", "", "of all levels", count},
      {"stored_vertices", "", "of all levels, a copy for each cell", count},
      {"stored_ratio", "", "stored triangles over those of the input", cost},
      {"bytes", "bytes", "of the file", cost},
      {"bytes_per_triangle", "bytes/triangle", "of the file, over the stored triangles", cost},
      {"read_seconds", "s", "reading the input file", cost},
      {"weld_seconds", "s", "cleaning, welding, normalising", cost},
      {"partition_seconds", "s", "of building: assigning triangles to cells", cost},
      {"hierarchy_seconds", "s", "of building: simplifying level by level", cost},
      {"write_seconds", "s", "writing the file", cost},
      {"measure_seconds", "s", "measuring errors", cost, {measured}},
      {"measure_cpu_seconds", "s", "processor time of measuring errors, all threads", cost, {measured}},
      {"mtri_per_core_second", "million/s", "input triangles over processor seconds of building", cost},
      {"peak_memory", "bytes", "largest resident set of reading, welding and building", cost},
      {"busy", "%", "of the workers' time, inside tasks", cost},
      {"idle_tail", "s", "at the end, with a worker that has nothing left to do", cost},
      {"rho", "", "reach: the least uniform kappa0 that is admissible", accuracy},
      {"diameter", "", "largest diameter of a cell's box over its size", accuracy},
      {"e", "", "largest error of a level over its cell size, as the builder estimates it or as it is measured",
       accuracy},
      {"max_edge", "", "longest edge of the finest level over its cell size", accuracy},
      {"long_edges", "", "half-edges of the finest level that are longer than sigma0 h_L", count},
      {"level", "", "that is held against the input; 0 is the coarsest", count},
      {"level_triangles", "", "of the level that is held against the input", count},
      {"level_e", "", "error of that level over its cell size, as the hierarchy states it", accuracy},
      {"level_distance", "", "largest distance found of that level from the input, over its cell size", accuracy},
      {"valid", "", "the hierarchy has every property that verify checks", label},
      {"failed_checks", "", "of verify", label},
      {"fingerprint", "", "of the triangles of the input", label},
      {"hash", "", "of all tables and payloads", label},
      {"twin_hash", "", "the same of a build by the serial strategy on one thread", label},
  };
  add_spread_columns(list, "seconds", "s", "building, from the mesh to packed levels");
  add_spread_columns(list, "cpu_seconds", "s", "processor time of building, all threads");
  append(list, geometry_columns());
  return list;
}

void add_counts(Row& row, const Hierarchy& hierarchy) {
  const Provenance& input = hierarchy.provenance;
  std::uint64_t triangles = 0, vertices = 0;
  for (const Level& level : hierarchy.levels) triangles += level.triangles, vertices += level.vertices;
  row["triangles"] = input.input_triangles, row["vertices"] = input.input_vertices;
  row["levels"] = hierarchy.levels.size(), row["cells"] = hierarchy.cells.size();
  row["stored_triangles"] = triangles, row["stored_vertices"] = vertices;
  row["stored_ratio"] = static_cast<double>(triangles) / static_cast<double>(input.input_triangles);
  row["fingerprint"] = to_hex(input.fingerprint);
}

// Bytes and seconds of a file that does not stay.
void add_file(Row& row, const Hierarchy& hierarchy, LodeForm form, const RunContext& context, Scheduler& scheduler) {
  const std::filesystem::path file = std::filesystem::path(context.directory) / "scratch.lode";
  const CpuClock clock;
  const std::uint64_t bytes = save_lode(hierarchy, file, scheduler, form);
  row["bytes"] = bytes;
  row["write_seconds"] = clock.elapsed().seconds;
  row["bytes_per_triangle"] = static_cast<double>(bytes) / row["stored_triangles"].get<double>();
  std::filesystem::remove(file);
}

// One level, held against the input.
void add_level(Row& row, const Hierarchy& hierarchy, const RawMesh& reference, const Parameters& parameters,
               Scheduler& scheduler) {
  const int level = std::max(hierarchy.finest() - parameters.integer("error_level"), 0);
  const Level& table = hierarchy.levels[static_cast<std::size_t>(level)];
  row["level"] = level, row["level_triangles"] = table.triangles, row["level_e"] = table.error;
  add_geometry(row, reference, level_mesh(hierarchy, level), scheduler);
  row["level_distance"] =
      row["error_max"].get<double>() / 100 * diagonal_of(reference) / (hierarchy.transform.scale * cell_size(level));
}

void add_accuracy(Row& row, const Hierarchy& hierarchy, const IndexedMesh& mesh, const Parameters& parameters,
                  const RunContext& context, Scheduler& scheduler) {
  float diameter = 0, error = 0;
  for (const Level& level : hierarchy.levels) {
    diameter = std::max(diameter, level.diameter);
    error = std::max(error, level.error);
  }
  row["rho"] = reach(hierarchy, DistanceMetric::euclidean), row["diameter"] = diameter, row["e"] = error;
  row["max_edge"] = hierarchy.levels.back().max_edge, row["long_edges"] = hierarchy.levels.back().long_edges;
  add_level(row, hierarchy, in_model_space(mesh), parameters, scheduler);

  check_cancelled(context);
  const VerifyReport report = verify_hierarchy(hierarchy, &mesh);
  row["valid"] = report.valid(), row["failed_checks"] = failed_checks(report);

  check_cancelled(context);
  BuildConfig twin = build_config(parameters, context);
  twin.order_cells = parameters.flag("compress"), twin.strategy = Strategy::serial;
  row["twin_hash"] = to_hex(hash_of(build_hierarchy(IndexedMesh(mesh), twin, *make_serial_scheduler())));
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const auto trace = std::make_shared<Trace>(study_scheduler(parameters)->workers());
  const auto scheduler = make_tracing_scheduler(study_scheduler(parameters), trace);
  BuildConfig config = build_config(parameters, context);
  const bool compress = config.order_cells = parameters.flag("compress");
  const Lattice lattice{compress ? Lattice::automatic : 0};
  Row row;
  {
    const CostMeter meter;
    (void)build_hierarchy(read_study_mesh(context, *scheduler, study_reading(), lattice).mesh, config, *scheduler);
    row["peak_memory"] = meter.elapsed().peak_memory;
  }
  const StudyMesh input = read_study_mesh(context, *scheduler, study_reading(), lattice);
  row["read_seconds"] = input.read.seconds, row["weld_seconds"] = input.weld.seconds;

  Hierarchy hierarchy;
  BuildReport report;
  double begin = 0;
  const Rounds times = time_rounds(parameters.integer("rounds"), context, [&] {
    IndexedMesh mesh = input.mesh;
    hierarchy = {};
    begin = trace->now();
    hierarchy = build_hierarchy(std::move(mesh), config, *scheduler, &report);
    return report.total;
  });
  const TraceSummary use = summarize(*trace, begin);  // of the last round
  add_spread(row, "seconds", times.wall);
  add_spread(row, "cpu_seconds", times.cpu);
  add_counts(row, hierarchy);
  row["partition_seconds"] = report.stages.at("partition").seconds;
  row["hierarchy_seconds"] = report.stages.at("hierarchy").seconds;
  row["mtri_per_core_second"] =
      static_cast<double>(hierarchy.provenance.input_triangles) * 1e-6 / row["cpu_seconds"].get<double>();
  row["busy"] = 100 * use.busy, row["idle_tail"] = use.idle_tail;
  row["hash"] = to_hex(hash_of(hierarchy));
  if (parameters.flag("measure_error")) {
    const CpuClock clock;
    (void)measure_errors(hierarchy, {{}, context.cancel, {}}, *scheduler);
    const StageTime time = clock.elapsed();
    row["measure_seconds"] = time.seconds, row["measure_cpu_seconds"] = time.cpu_seconds;
  }
  add_file(row, hierarchy, compress ? LodeForm::compressed : LodeForm::plain, context, *scheduler);
  if (context.repetition == 0) add_accuracy(row, hierarchy, input.mesh, parameters, context, *scheduler);
  return {row};
}

std::vector<SettingFault> check(const Parameters& parameters) {
  SettingVerdict verdict;
  check_build(verdict, parameters);
  return std::move(verdict).faults();
}

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.spread("seconds");
  verdict.spread("cpu_seconds");
  verdict.present("hash");
  verdict.present("fingerprint");
  verdict.is_true("valid");
  verdict.equal("hash", "twin_hash");
  verdict.in_order("triangles", "stored_triangles");
  verdict.at_most("busy", 100.001);
  verdict.in_order("level_triangles", "triangles");
  // A measured error is a bound, but for the rounding of what is compared with it.
  if (parameters.flag("measure_error"))
    for (const Row& row : rows)
      verdict.require(number_in(row, "level_distance").value_or(0) <= number_in(row, "level_e").value_or(0) + 1e-4,
                      "a distance is larger than the measured error of its level");
  check_geometry(verdict);
  for (const Row& row : rows)
    verdict.require(text_in(row, "failed_checks").empty(), "failed checks: " + text_in(row, "failed_checks"));
  return std::move(verdict).messages();
}

}  // namespace

Experiment build_experiment() {
  return {"build",   "What does a hierarchy cost to build, and how far are its levels from the input?",
          true,      parameters(),
          columns(), run,
          verify,    check};
}

}  // namespace lodestone
