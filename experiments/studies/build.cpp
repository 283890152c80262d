// Experiment `build`: what making a hierarchy costs, and how good the levels are.
#include "experiments/subjects/build.h"

#include <filesystem>

#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/verify/verify.h"
#include "core/mesh/raw_mesh.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/compare.h"
#include "experiments/subjects/result_hash.h"
#include "parallel/hierarchy/measure_errors.h"
#include "parallel/hierarchy/save.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace build_study {

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{threads_parameter(), rounds_parameter(3)};
  append(list, in_core_build_parameters());
  list.push_back({"compress", false, "", "the file is a compressed one, its vertices on a lattice", 0, 0, {}});
  list.push_back(
      as_condition({"error_level", 2, "", "levels above the finest whose mesh is held against the input", 0, 20, {}}));
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  // Building alone is repeated, in memory; the file is read and written once.
  std::vector<ColumnInfo> list =
      without(build_columns(), {"out_of_core", "scratch_bytes", "spill_seconds", "file_seconds", "file_cpu_seconds",
                                "file_mtri_per_core_second"});
  for (ColumnInfo& column : list)
    if (column.name.starts_with("measure_")) column.needs.push_back({{{"measure_error", true}}});
  append(list, spread_ends(list, {"seconds", "cpu_seconds"}));
  append(list,
         {{"level", "", "level that is held against the input; 0 is the coarsest", count},
          {"level_triangles", "", "triangles of that level", count},
          {"level_e", "", "error of that level over its cell size, as the hierarchy states it", accuracy},
          {"level_distance", "", "largest distance found of that level from the input, over its cell size", accuracy},
          {"hash", "", "hash of all tables and payloads, before errors are measured", label},
          {"twin_hash", "", "hash of a build by the serial strategy on one thread", label}});
  append(list, verify_columns());
  append(list, geometry_columns());
  return list;
}

// A build in rounds, and what it works on.
class BuildRounds {
 public:
  BuildRounds(const Parameters& parameters, const RunContext& context)
      : study_(parameters, context),
        trace_(std::make_shared<Trace>(study_.scheduler->workers())),
        config_(build_config(parameters, context)) {
    study_.scheduler = make_tracing_scheduler(std::move(study_.scheduler), trace_);
    config_.order_cells = parameters.flag("compress");
  }

  Row row() {
    build();
    const std::string hash = to_hex(hash_of(result_.hierarchy));
    if (study_.parameters.flag("measure_error")) measure();
    write_scratch();
    Row row = restricted_to(columns(), to_row(result_));
    add_times(row, times_);
    row["hash"] = hash;
    if (study_.context.repetition == 0) add_accuracy(row);
    return row;
  }

 private:
  [[nodiscard]] StudyMesh read() const {
    const Lattice lattice{config_.order_cells ? Lattice::automatic : 0};
    return read_study_mesh(study_.context, *study_.scheduler, study_reading(), lattice);
  }

  void build() {
    {
      const CostMeter meter;
      (void)build_hierarchy(read().mesh, config_, *study_.scheduler);
      result_.peak_bytes = meter.elapsed().peak_memory;
    }
    StudyMesh input = read();
    result_.stages = {{"read", input.read}, {"weld", input.weld}};
    mesh_ = std::move(input.mesh);
    double begin = 0;
    times_ = time_rounds(study_.parameters.integer("rounds"), study_.context, [&] {
      IndexedMesh mesh = mesh_;
      result_.hierarchy = {};
      begin = trace_->now();
      result_.hierarchy = build_hierarchy(std::move(mesh), config_, *study_.scheduler, &result_.report);
      return result_.report.total;
    });
    result_.use = summarize(*trace_, begin);  // of the last round
    result_.report.total = times_.median();
  }

  void measure() {
    const CpuClock clock;
    (void)measure_errors(result_.hierarchy, {.cancel = study_.context.cancel}, *study_.scheduler);
    result_.stages["measure"] = clock.elapsed();
  }

  // The file is not kept.
  void write_scratch() {
    const std::filesystem::path file = std::filesystem::path(study_.context.directory) / "scratch.lode";
    const CpuClock clock;
    result_.file_bytes = save_lode(result_.hierarchy, file, *study_.scheduler,
                                   config_.order_cells ? LodeForm::compressed : LodeForm::plain);
    result_.stages["write"] = clock.elapsed();
    std::filesystem::remove(file);
  }

  void add_accuracy(Row& row) const {
    add_level(row);
    check_cancelled(study_.context);
    add_verification(row, result_.hierarchy, *study_.scheduler, &mesh_);
    check_cancelled(study_.context);
    BuildConfig twin = config_;
    twin.strategy = Strategy::serial;
    row["twin_hash"] = to_hex(hash_of(build_hierarchy(IndexedMesh(mesh_), twin, *make_serial_scheduler())));
  }

  // One level, held against the input.
  void add_level(Row& row) const {
    const Hierarchy& hierarchy = result_.hierarchy;
    const RawMesh reference = in_model_space(mesh_);
    const int level = std::max(hierarchy.finest() - study_.parameters.integer("error_level"), 0);
    const Level& table = hierarchy.levels[static_cast<std::size_t>(level)];
    row["level"] = level, row["level_triangles"] = table.triangles, row["level_e"] = table.error;
    add_geometry(row, reference, level_mesh(hierarchy, level), *study_.scheduler);
    row["level_distance"] = row["error_max"].get<double>() / 100 * diagonal_of(reference) /
                            (hierarchy.transform.scale * hierarchy.cell_size(level));
  }

  Study study_;
  std::shared_ptr<Trace> trace_;
  BuildConfig config_;
  BuildResult result_;
  IndexedMesh mesh_;
  Rounds times_;
};

std::vector<Row> rows_of(const Parameters& parameters, const RunContext& context) {
  return {BuildRounds(parameters, context).row()};
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
  verdict.equal("hash", "twin_hash");
  verdict.in_order("input_triangles", "stored_triangles");
  verdict.at_most("busy", 100.001);
  verdict.in_order("level_triangles", "input_triangles");
  check_verification(verdict);
  check_geometry(verdict);
  // A measured error is a bound, except for the rounding of what is compared with it.
  if (parameters.flag("measure_error"))
    for (const Row& row : rows)
      verdict.require(number_in(row, "level_distance").value_or(0) <= number_in(row, "level_e").value_or(0) + 1e-4,
                      "a distance is larger than the measured error of its level");
  return std::move(verdict).messages();
}

}  // namespace build_study

Experiment build_experiment() {
  using namespace build_study;
  return {"build",   "What does a hierarchy cost to build, and how far are its levels from the input?",
          true,      parameters(),
          columns(), rows_of,
          verify,    check};
}

}  // namespace lodestone
