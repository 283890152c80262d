#include "experiments/studies/study_input.h"

#include <algorithm>
#include <iterator>

#include "core/base/error.h"
#include "core/simplify/simplifiers.h"
#include "experiments/subjects/compare.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/measure_errors.h"
#include "parallel/mesh/load.h"
#include "parallel/scheduler/clock.h"
#include "render/lod/verify_radii.h"

namespace lodestone {
void append(std::vector<ParameterInfo>& list, std::vector<ParameterInfo> more) {
  list.insert(list.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::vector<ColumnInfo> needing(const ColumnNeed& need, std::vector<ColumnInfo> columns) {
  for (ColumnInfo& column : columns) column.needs.push_back(need);
  return columns;
}

ParameterInfo threads_parameter() {
  return as_condition(
      {"threads", 0, "", "workers, and processors to be pinned to; 0: all that there are", 0, 4096, {}});
}

ParameterInfo cell_triangles_parameter() {
  return {"cell_triangles",
          BuildConfig{}.cell_triangles,
          "",
          "mean triangles per finest cell that L is chosen for",
          1,
          1e9,
          {}};
}

std::vector<ParameterInfo> build_parameters() {
  const BuildConfig config;
  return {
      {"sigma0", 0.4, "", "displacement bound: |v - P(v)| <= sigma0 h / 2", 1e-4, 2, {}},
      cell_triangles_parameter(),
      {"finest_level", -1, "", "L; -1: from cell_triangles", -1, max_level, {}},
      {"half_levels", false, "", "levels of a half of the triangles instead of a quarter", 0, 0, {}},
      {"simplifier", "quadric", "", "what collapses", 0, 0, simplifier_names()},
      {"placement", "default", "", "where survivors stand", 0, 0, {"default", "optimal", "endpoint"}},
      {"strategy", "graph", "", "how the work is orchestrated", 0, 0, {"serial", "levels", "graph"}},
  };
}

std::vector<ParameterInfo> in_core_build_parameters() {
  std::vector<ParameterInfo> list = build_parameters();
  list.push_back({"refine", false, "", "edges longer than sigma0 h_L are split before", 0, 0, {}});
  list.push_back(
      {"measure_error", false, "", "errors of the levels are measured bounds instead of estimates", 0, 0, {}});
  return list;
}

std::vector<ParameterInfo> picture_parameters() {
  return {
      as_condition({"width", 640, "pixels", "of the picture", 16, 16384, {}}),
      as_condition({"height", 360, "pixels", "of the picture", 16, 16384, {}}),
      as_condition({"samples", 1, "", "samples a pixel: 1 or 4", 1, 4, {}}),
  };
}

void check_build(SettingVerdict& verdict, const Parameters& parameters) {
  const std::string simplifier = parameters.text("simplifier");
  const std::vector<Placement>& known = placements_of(simplifier);
  const std::string placing = parameters.text("placement");
  verdict.require(placing == "default" || std::ranges::find(known, placement_named(placing)) != known.end(),
                  {"simplifier", "placement"},
                  assignment(parameters, "simplifier") + " does not know the placement " + placing + "; only " +
                      simplifiers_that_know(placing == "default" ? known.front() : placement_named(placing)) + " does");
  verdict.idle(known.size() == 1, "placement", assignment(parameters, "simplifier"));
  verdict.idle(parameters.integer("finest_level") >= 0, "cell_triangles", assignment(parameters, "finest_level"));
}

void check_picture(SettingVerdict& verdict, const Parameters& parameters) {
  const int samples = parameters.integer("samples");
  verdict.require(samples == 1 || samples == 4, {"samples"},
                  assignment(parameters, "samples") + ": a pixel has 1 or 4 samples");
}

ImageSize view_size(const Parameters& parameters) {
  return {parameters.integer("width"), parameters.integer("height")};
}

std::unique_ptr<Scheduler> study_scheduler(const Parameters& parameters) {
  return make_tbb_scheduler(parameters.integer("threads"));
}

BuildConfig build_config(const Parameters& parameters, const RunContext& context) {
  BuildConfig config;
  config.sigma0 = static_cast<float>(parameters.number("sigma0"));
  config.cell_triangles = static_cast<std::uint32_t>(parameters.integer("cell_triangles"));
  config.finest_level = parameters.integer("finest_level");
  config.half_levels = parameters.flag("half_levels");
  config.simplifier = parameters.text("simplifier");
  if (parameters.text("placement") != "default") config.placement = placement_named(parameters.text("placement"));
  config.strategy = strategy_named(parameters.text("strategy"));
  config.refine = parameters.json().value("refine", false);
  config.cancel = context.cancel;
  return config;
}

ReadConfig study_reading() {
  ReadConfig reading;
  reading.attributes = false;
  reading.fill_voids = true;
  return reading;
}

StudyMesh read_study_mesh(const RunContext& context, Scheduler& scheduler, const ReadConfig& reading, Lattice lattice) {
  if (context.input.empty()) throw InputError("the run has no input; name data in its sweep");
  StudyMesh result;
  const CpuClock reading_clock;
  RawMesh raw = load_mesh(context.input, scheduler, reading);
  result.read = reading_clock.elapsed();
  const CpuClock welding_clock;
  Repairs repairs;
  result.mesh = prepare_mesh(std::move(raw), repairs, scheduler, context.input, lattice);
  result.weld = welding_clock.elapsed();
  return result;
}

Hierarchy build_study_hierarchy(const Parameters& parameters, const RunContext& context, Scheduler& scheduler) {
  Hierarchy hierarchy =
      build_hierarchy(read_study_mesh(context, scheduler).mesh, build_config(parameters, context), scheduler);
  if (parameters.json().value("measure_error", false))
    (void)measure_errors(hierarchy, {.cancel = context.cancel}, scheduler);
  return hierarchy;
}

void add_geometry(Row& row, const RawMesh& reference, const RawMesh& mesh, Scheduler& scheduler) {
  row.update(to_row(geometry_error(reference, mesh, {}, scheduler)));
}

void check_geometry(RowVerdict& verdict) {
  verdict.in_order("error_mean", "rms");
  verdict.in_order("rms", "error_max");
  verdict.in_order("error_p99", "error_max");
  verdict.at_most("slivers", 100);
  verdict.at_most("normal_mean", 180);
}

std::vector<ColumnInfo> verify_columns() {
  using enum ColumnInfo::Kind;
  return {{"valid", "", "the hierarchy has every property that verify checks", label},
          {"failed_checks", "", "names of the properties that it does not have", label}};
}

void add_verification(Row& row, const Hierarchy& hierarchy, const Scheduler& scheduler, const IndexedMesh* input) {
  const VerifyReport report = verify_with_radii(hierarchy, scheduler, input);
  std::string failed;
  for (const VerifyCheck& check : report.checks)
    if (!check.passed) failed += (failed.empty() ? "" : ", ") + check.name;
  row["valid"] = report.valid(), row["failed_checks"] = failed;
}

void check_verification(RowVerdict& verdict) {
  verdict.is_true("valid");
  for (const Row& row : verdict.rows())
    if (const std::string failed = text_in(row, "failed_checks"); !failed.empty())
      verdict.require(false, "failed checks: " + failed);
}

}  // namespace lodestone
