// Experiment `progressive`: a progressive mesh, what it costs and how good its levels are.
#include <algorithm>
#include <filesystem>

#include "core/base/error.h"
#include "core/mesh/raw_mesh.h"
#include "core/progressive/mesh/level.h"
#include "core/progressive/progressive_file.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/metrics/cracks/progressive_cracks.h"
#include "experiments/studies/catalogue.h"
#include "experiments/studies/geometry_columns.h"
#include "experiments/studies/result_hash.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/row_verdict.h"
#include "experiments/studies/study_input.h"
#include "parallel/progressive/make_progressive.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

std::vector<ParameterInfo> parameters() {
  return {
      threads_parameter(),
      rounds_parameter(3),
      {"metric", "quadric", "", "by which collapses are ranked", 0, 0, {"quadric", "attribute-quadric", "parametric"}},
      {"base", 0, "triangles", "to stop at; 0: when nothing can collapse", 0, 1e9, {}},
      {"level_count", 4, "", "levels to measure, each of a fourth of the triangles of the one before", 1, 15, {}},
  };
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list{
      {"input_triangles", "", "of the input", count},
      {"base_triangles", "", "of the base mesh", count},
      {"triangles", "", "of the level", count},
      {"vertices", "", "of the level", count},
      {"share", "%", "triangles of the level over those of the input", count},
      {"error_estimate", "% of the diagonal", "of the level, by the metric", accuracy},
      {"level_seconds", "s", "taking the level out of the progressive mesh", cost},
      {"ktri_per_core_second", "thousand/s", "input triangles over processor seconds", cost},
      {"peak_memory", "bytes", "largest resident set while collapsing, the input included", cost},
      {"cut_vertices", "", "copies made where the surface is no manifold", count},
      {"residual_edges", "", "cracks of the level: edges of its border that are no image of the input's", count},
      {"bytes_per_vertex", "bytes/vertex", "of an .lpm of the whole ladder, without images, over its vertices", cost},
      {"hash", "", "of the progressive mesh", label},
      {"same", "", "all rounds and a single worker make the same", label},
  };
  add_spread_columns(list, "seconds", "s", "making the progressive mesh");
  add_spread_columns(list, "cpu_seconds", "s", "processor time of all threads");
  append(list, geometry_columns());
  return list;
}

struct Made {
  ProgressiveMesh mesh;
  Rounds times;
  std::uint64_t cut_vertices = 0, hash = 0, peak_memory = 0;
  bool same = true;
};

Made make(const IndexedMesh& mesh, const Parameters& parameters, const RunContext& context, Scheduler& scheduler) {
  ProgressiveConfig config;
  config.metric = progressive::metric_kind(parameters.text("metric"));
  config.base_triangles = static_cast<std::size_t>(parameters.integer("base"));
  Made made;
  const CostMeter meter;
  made.times = time_rounds(parameters.integer("rounds"), context, [&] {
    made.mesh = {};
    ProgressiveReport report;
    const CpuClock clock;
    made.mesh = make_progressive(mesh, config, scheduler, report);
    const StageTime time = clock.elapsed();
    made.cut_vertices = report.cut_vertices;
    made.same = made.same && (made.hash == 0 || made.hash == hash_of(made.mesh));
    made.hash = hash_of(made.mesh);
    return time;
  });
  made.peak_memory = meter.elapsed().peak_memory;
  if (context.repetition == 0) {
    ProgressiveReport report;
    made.same = made.same && made.hash == hash_of(make_progressive(mesh, config, *make_serial_scheduler(), report));
  }
  return made;
}

Row level_row(const Made& made, const LevelFinder& levels, std::uint32_t vertices, const RawMesh& reference,
              const RunContext& context, Scheduler& scheduler) {
  const CpuClock clock;
  const std::vector<Triangle> triangles = levels.compute_level(vertices);
  Row row;
  row["level_seconds"] = clock.elapsed().seconds;
  row["triangles"] = triangles.size(), row["vertices"] = vertices;
  row["share"] = 100.0 * static_cast<double>(triangles.size()) / static_cast<double>(reference.triangles.size());
  if (context.repetition > 0 || triangles.empty()) return row;
  row["residual_edges"] = residual_edges(made.mesh, vertices);
  add_geometry(row, reference, levels.level_mesh(vertices), scheduler);
  return row;
}

// The file does not stay.
double lpm_bytes_per_vertex(const ProgressiveMesh& mesh, const RunContext& context) {
  const std::filesystem::path file = std::filesystem::path(context.directory) / "scratch.lpm";
  const ProgressiveFileSize size = save_progressive(mesh, file);
  std::filesystem::remove(file);
  return static_cast<double>(size.geometry) / static_cast<double>(mesh.positions.size());
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const auto scheduler = study_scheduler(parameters);
  ReadConfig reading = study_reading();
  reading.attributes = parameters.text("metric") != "quadric";
  const IndexedMesh mesh = read_study_mesh(context, *scheduler, reading).mesh;
  const Made made = make(mesh, parameters, context, *scheduler);
  const LevelFinder levels(made.mesh);
  const RawMesh reference = in_model_space(mesh);
  const double core_seconds = spread_of(made.times.cpu).median;

  const double bytes_per_vertex = lpm_bytes_per_vertex(made.mesh, context);

  std::vector<Row> rows;
  std::size_t target = mesh.triangles.size();
  for (int level = 0; level < parameters.integer("level_count"); ++level) {
    check_cancelled(context);
    target /= 4;
    const std::uint32_t vertices = levels.vertices_for_triangles(target);
    if (!rows.empty() && rows.back()["vertices"] == vertices) break;  // the base has been reached
    Row row = level_row(made, levels, vertices, reference, context, *scheduler);
    row["input_triangles"] = mesh.triangles.size(),
    row["base_triangles"] = levels.triangles_of(made.mesh.base_vertices);
    row["error_estimate"] = 100 * levels.error_of(vertices) * made.mesh.transform.scale / diagonal_of(reference);
    row["ktri_per_core_second"] = static_cast<double>(mesh.triangles.size()) * 1e-3 / core_seconds;
    row["peak_memory"] = made.peak_memory, row["cut_vertices"] = made.cut_vertices;
    row["bytes_per_vertex"] = bytes_per_vertex;
    row["hash"] = to_hex(made.hash), row["same"] = made.same;
    add_spread(row, "seconds", made.times.wall);
    add_spread(row, "cpu_seconds", made.times.cpu);
    rows.push_back(std::move(row));
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

}  // namespace

Experiment progressive_experiment() {
  return {"progressive", "What does a progressive mesh cost, and how far are its levels from the input?",
          true,          parameters(),
          columns(),     run,
          verify};
}

}  // namespace lodestone
