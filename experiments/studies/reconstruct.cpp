// Experiment `reconstruct`: levels from position maps, what they cost and how good they are.
#include "experiments/subjects/reconstruct.h"

#include <algorithm>

#include "core/base/error.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/result_hash.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/make_renderer.h"
#include "render/position_map/map_view.h"

namespace lodestone {
namespace reconstruct_study {

std::vector<ParameterInfo> parameters() {
  return {
      threads_parameter(),
      rounds_parameter(3),
      {"resolution", 256.0, "pixels", "along the longest side of the bounding box", 8, largest_map_side, {}},
      {"detail",
       2.0,
       "",
       "factor by which maps are drawn finer; the mesh is simplified to the resolution; 1: not",
       1,
       16,
       {}},
      {"views", 0, "", "views in all; 6: the faces of the box; 0: as many as the uncovered area asks for", 0, 999, {}},
      {"merge", "stitch", "", "how the views become one mesh", 0, 0, {"stitch", "concatenate"}},
      {"projection", "orthographic", "", "of the views", 0, 0, {"orthographic", "perspective"}},
      as_condition({"backend", "soft", "", "that draws the maps", 0, 0, map_backend_names()}),
      {"condense", true, "", "maps are drawn at twice the resolution and condensed", 0, 0, {}},
      {"sharp", 35.0, "degrees", "angle from which sharp features are recovered; 0: none", 0, 179, {}},
  };
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list = reconstruct_columns();
  append(list, spread_ends(list, {"seconds", "cpu_seconds"}));
  append(list, {{"hash", "", "hash of the result", label},
                {"same", "", "all rounds and a single worker make the same mesh", label}});
  return list;
}

ReconstructConfig config_of(const Parameters& parameters) {
  ReconstructConfig config;
  config.resolution = parameters.number("resolution");
  config.detail = parameters.number("detail");
  if (const int views = parameters.integer("views"); views > 0) config.views.most = config.views.least = views;
  config.merge = merge_kind(parameters.text("merge"));
  config.projection = projection_kind(parameters.text("projection"));
  config.backend = parameters.text("backend");
  config.condense = parameters.flag("condense");
  config.sharp_degrees = static_cast<float>(parameters.number("sharp"));
  return config;
}

std::vector<Row> rows_of(const Parameters& parameters, const RunContext& context) {
  const Study study(parameters, context);
  const IndexedMesh mesh = read_study_mesh(context, *study.scheduler).mesh;
  const ReconstructConfig config = config_of(parameters);
  Reconstruction made;
  bool same = true;
  std::uint64_t hash = 0;
  const CostMeter meter;
  const Rounds times = time_rounds(parameters.integer("rounds"), context, [&] {
    made = {};
    const CpuClock clock;
    made = reconstruct(mesh, config, *study.scheduler);
    const StageTime time = clock.elapsed();
    same = same && (hash == 0 || hash == hash_of(made.mesh));
    hash = hash_of(made.mesh);
    return time;
  });
  const std::uint64_t peak_bytes = meter.elapsed().peak_memory;
  if (made.mesh.triangles.empty())
    throw InputError(context.input + ": no view sees three neighbouring samples; raise resolution");
  ReconstructResult result = result_of(made, mesh.transform);
  result.input_triangles = mesh.triangles.size();
  result.time = times.median();
  result.peak_bytes = peak_bytes;
  if (context.repetition == 0) {
    measure(result, made, mesh, *study.scheduler);
    check_cancelled(context);
    if (config.backend == "soft")
      same = same && hash == hash_of(reconstruct(mesh, config, *make_serial_scheduler()).mesh);
  }
  Row row = to_row(result);
  add_times(row, times);
  row["hash"] = to_hex(hash), row["same"] = same;
  return {row};
}

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.spread("seconds");
  verdict.spread("cpu_seconds");
  verdict.present("hash");
  verdict.is_true("same");
  verdict.at_most("coverage", 100);
  check_geometry(verdict);
  if (parameters.text("merge") == "stitch") verdict.is_true("manifold");
  for (const Row& row : rows) verdict.require(number_in(row, "triangles").value_or(0) > 0, "the result is empty");
  return std::move(verdict).messages();
}

}  // namespace reconstruct_study

Experiment reconstruct_experiment() {
  using namespace reconstruct_study;
  return {"reconstruct", "What do levels from position maps cost, and how much of the surface do they keep?",
          true,          parameters(),
          columns(),     rows_of,
          verify};
}

}  // namespace lodestone
