// Experiment `progressive`: a progressive mesh, what it costs and how good its levels are.
#include "experiments/subjects/progressive.h"

#include <algorithm>
#include <filesystem>

#include "core/mesh/raw_mesh.h"
#include "core/progressive/mesh/level.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/metrics/cracks/progressive_cracks.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/compare.h"
#include "experiments/subjects/result_hash.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace progressive_study {

std::vector<ParameterInfo> parameters() {
  return {
      threads_parameter(),
      rounds_parameter(3),
      {"metric", "quadric", "", "by which collapses are ranked", 0, 0, {"quadric", "attribute-quadric", "parametric"}},
      {"base", 0, "triangles", "to stop at; 0: when nothing can collapse", 0, 1e9, {}},
      as_condition(
          {"level_count", 4, "", "levels to measure, each of a fourth of the triangles of the one before", 1, 15, {}}),
  };
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list = progressive_columns();
  append(list, spread_ends(list, {"seconds", "cpu_seconds"}));
  append(list, {{"triangles", "", "triangles of the level", count},
                {"vertices", "", "vertices of the level", count},
                {"share", "%", "triangles of the level over those of the input", count},
                {"error_estimate", "% of the diagonal", "error of the level, by the metric", accuracy},
                {"level_seconds", "s", "taking the level out of the progressive mesh", cost},
                {"hash", "", "hash of the progressive mesh", label},
                {"same", "", "all rounds and a single worker make the same", label}});
  append(list, geometry_columns());
  return list;
}

struct Made {
  ProgressiveResult result;
  Rounds times;
  std::uint64_t hash = 0;
  bool same = true;
};

Made make(const IndexedMesh& mesh, const Study& study) {
  ProgressiveConfig config;
  config.metric = progressive::metric_kind(study.parameters.text("metric"));
  config.base_triangles = static_cast<std::size_t>(study.parameters.integer("base"));
  Made made;
  const CostMeter meter;
  made.times = time_rounds(study.parameters.integer("rounds"), study.context, [&] {
    made.result.mesh = {};
    const CpuClock clock;
    made.result.mesh = make_progressive(mesh, config, *study.scheduler, made.result.report);
    const StageTime time = clock.elapsed();
    const std::uint64_t hash = hash_of(made.result.mesh);
    made.same = made.same && (made.hash == 0 || made.hash == hash);
    made.hash = hash;
    return time;
  });
  made.result.peak_bytes = meter.elapsed().peak_memory;
  made.result.time = made.times.median();
  if (study.context.repetition == 0) {
    ProgressiveReport report;
    made.same = made.same && made.hash == hash_of(make_progressive(mesh, config, *make_serial_scheduler(), report));
  }
  return made;
}

// The size of the whole mesh as an .lpm, which is not kept.
ProgressiveFileSize lpm_size(const ProgressiveMesh& mesh, const RunContext& context) {
  const std::filesystem::path file = std::filesystem::path(context.directory) / "scratch.lpm";
  const ProgressiveFileSize size = save_progressive(mesh, file);
  std::filesystem::remove(file);
  return size;
}

Row level_row(const ProgressiveMesh& mesh, const LevelFinder& levels, std::uint32_t vertices, const RawMesh& reference,
              const Study& study) {
  const CpuClock clock;
  const std::vector<Triangle> triangles = levels.compute_level(vertices);
  Row row;
  row["level_seconds"] = clock.elapsed().seconds;
  row["triangles"] = triangles.size(), row["vertices"] = vertices;
  row["share"] = 100.0 * static_cast<double>(triangles.size()) / static_cast<double>(reference.triangles.size());
  row["error_estimate"] = 100 * levels.error_of(vertices) * mesh.transform.scale / diagonal_of(reference);
  if (study.context.repetition > 0 || triangles.empty()) return row;
  row["residual_edges"] = residual_edges(mesh, vertices);
  add_geometry(row, reference, levels.level_mesh(vertices), *study.scheduler);
  return row;
}

std::vector<Row> rows_of(const Parameters& parameters, const RunContext& context) {
  const Study study(parameters, context);
  ReadConfig reading = study_reading();
  reading.attributes = parameters.text("metric") != "quadric";
  const IndexedMesh mesh = read_study_mesh(context, *study.scheduler, reading).mesh;
  Made made = make(mesh, study);
  made.result.size = lpm_size(made.result.mesh, context);
  const LevelFinder levels(made.result.mesh);
  const RawMesh reference = in_model_space(mesh);
  Row common = restricted_to(columns(), to_row(made.result));
  add_times(common, made.times);
  common["hash"] = to_hex(made.hash), common["same"] = made.same;

  std::vector<Row> rows;
  std::size_t target = mesh.triangles.size();
  for (int level = 0; level < parameters.integer("level_count"); ++level) {
    check_cancelled(context);
    target /= 4;
    const std::uint32_t vertices = levels.vertices_for_triangles(target);
    if (!rows.empty() && rows.back()["vertices"] == vertices) break;  // the base has been reached
    rows.push_back(common);
    rows.back().update(level_row(made.result.mesh, levels, vertices, reference, study));
  }
  return rows;
}

std::vector<std::string> verify(const Parameters&, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.spread("seconds");
  verdict.spread("cpu_seconds");
  verdict.present("hash");
  verdict.is_true("same");
  verdict.at_most("residual_edges", 0);
  verdict.in_order("base_triangles", "triangles");
  verdict.in_order("triangles", "input_triangles");
  check_geometry(verdict);
  return std::move(verdict).messages();
}

}  // namespace progressive_study

Experiment progressive_experiment() {
  using namespace progressive_study;
  return {"progressive", "What does a progressive mesh cost, and how far are its levels from the input?",
          true,          parameters(),
          columns(),     rows_of,
          verify};
}

}  // namespace lodestone
