// Experiment `reconstruct`: levels from position maps, what they cost and how good they are.
#include "render/reconstruct/reconstruct.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/mesh/raw_mesh.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/metrics/drawn/position_resolution.h"
#include "experiments/metrics/geometry/mesh_quality.h"
#include "experiments/metrics/geometry/surface_coverage.h"
#include "experiments/studies/catalogue.h"
#include "experiments/studies/geometry_columns.h"
#include "experiments/studies/result_hash.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/row_verdict.h"
#include "experiments/studies/study_input.h"
#include "parallel/scheduler/clock.h"
#include "render/position_map/map_view.h"

namespace lodestone {
namespace {

std::vector<ParameterInfo> parameters() {
  return {
      threads_parameter(),
      rounds_parameter(3),
      {"resolution", 256.0, "pixels", "along the longest side of the bounding box", 8, largest_map_side, {}},
      {"views", 0, "", "views in all; 6: the faces of the box; 0: as many as the uncovered area asks for", 0, 999, {}},
      {"merge", "stitch", "", "how the views become one mesh", 0, 0, {"stitch", "concatenate"}},
      {"projection", "orthographic", "", "of the views", 0, 0, {"orthographic", "perspective"}},
      {"backend", "soft", "", "that draws the maps", 0, 0, {"soft", "gl"}},
      {"detail",
       2.0,
       "",
       "maps are drawn so many times finer, and the mesh is simplified to the resolution; 1: not",
       1,
       16,
       {}},
      {"condense", true, "", "maps are drawn at twice the resolution and condensed", 0, 0, {}},
      {"sharp", 35.0, "degrees", "angle from which sharp features are recovered; 0: none", 0, 179, {}},
  };
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list{
      {"input_triangles", "", "of the input", count},
      {"triangles", "", "of the result", count},
      {"vertices", "", "of the result", count},
      {"pixels", "", "of all maps", count},
      {"view_count", "", "views that were drawn", count},
      {"inside_views", "", "views whose near plane lies beyond what is in the way", count},
      {"view_triangles", "", "of all views' meshes, before they are merged", count},
      {"coverage", "%", "of the visible surface that has the result within a sample's spacing", accuracy},
      {"visible_rms", "% of the diagonal", "distance of the visible surface from the result, root of the mean square",
       accuracy},
      {"border_edges", "", "of the result", count},
      {"euler", "", "Euler characteristic of the result", label},
      {"holes_filled", "", "between the views", count},
      {"manifold", "", "no edge of more than two triangles, no vertex of more than one fan", label},
      {"closed", "", "the result has no border", label},
      {"input_closed", "", "the input has no border", label},
      {"views_seconds", "s", "choosing views", cost},
      {"draw_seconds", "s", "drawing the maps", cost},
      {"connect_seconds", "s", "connecting pixels", cost},
      {"merge_seconds", "s", "merging the views", cost},
      {"sharpen_seconds", "s", "recovering sharp features", cost},
      {"simplify_seconds", "s", "simplifying to the resolution", cost},
      {"mpixels_per_core_second", "million/s", "pixels of the maps over processor seconds", cost},
      {"peak_memory", "bytes", "largest resident set while reconstructing, the input included", cost},
      {"hash", "", "of the result", label},
      {"same", "", "all rounds and a single worker make the same mesh", label},
  };
  add_spread_columns(list, "seconds", "s", "from the mesh to the new one");
  add_spread_columns(list, "cpu_seconds", "s", "processor time of all threads");
  append(list, geometry_columns());
  return list;
}

ReconstructConfig config_of(const Parameters& parameters) {
  ReconstructConfig config;
  config.resolution = parameters.number("resolution");
  if (const int views = parameters.integer("views"); views > 0) config.views.most = config.views.least = views;
  config.merge = parameters.text("merge") == "stitch" ? MergeKind::stitch : MergeKind::concatenate;
  config.projection =
      parameters.text("projection") == "perspective" ? Projection::perspective : Projection::orthographic;
  config.backend = parameters.text("backend");
  config.detail = parameters.number("detail");
  config.condense = parameters.flag("condense");
  config.sharp_degrees = static_cast<float>(parameters.number("sharp"));
  return config;
}

void add_counts(Row& row, const Reconstruction& made) {
  const ReconstructReport& report = made.report;
  row["triangles"] = made.mesh.triangles.size(), row["vertices"] = made.mesh.positions.size();
  row["pixels"] = report.pixels, row["view_count"] = report.views.directions.size();
  row["inside_views"] = report.views.inside.size(), row["holes_filled"] = report.stitch.holes_filled;
  row["view_triangles"] = report.view_triangles, row["input_closed"] = report.closed;
  row["views_seconds"] = report.choose.seconds, row["draw_seconds"] = report.draw.seconds;
  row["connect_seconds"] = report.connect.seconds, row["merge_seconds"] = report.merge.seconds;
  row["sharpen_seconds"] = report.sharpen_time.seconds, row["simplify_seconds"] = report.simplify.seconds;
  const MeshQuality quality = measure_quality(made.mesh.positions, made.mesh.triangles);
  row["border_edges"] = quality.border_edges, row["manifold"] = quality.manifold(), row["closed"] = quality.closed();
  row["euler"] = std::to_string(quality.euler);
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const auto scheduler = study_scheduler(parameters);
  const IndexedMesh mesh = read_study_mesh(context, *scheduler).mesh;
  const ReconstructConfig config = config_of(parameters);
  Row row;
  Reconstruction made;
  bool same = true;
  std::uint64_t hash = 0;
  const CostMeter meter;
  const Rounds times = time_rounds(parameters.integer("rounds"), context, [&] {
    made = {};
    const CpuClock clock;
    made = reconstruct(mesh, config, *scheduler);
    const StageTime time = clock.elapsed();
    same = same && (hash == 0 || hash == hash_of(made.mesh));
    hash = hash_of(made.mesh);
    return time;
  });
  row["peak_memory"] = meter.elapsed().peak_memory;
  if (made.mesh.triangles.empty())
    throw InputError(context.input + ": no view sees three neighbouring samples; raise resolution");
  add_spread(row, "seconds", times.wall);
  add_spread(row, "cpu_seconds", times.cpu);
  add_counts(row, made);
  row["input_triangles"] = mesh.triangles.size();
  row["mpixels_per_core_second"] = static_cast<double>(made.report.pixels) * 1e-6 / row["cpu_seconds"].get<double>();
  row["hash"] = to_hex(hash);
  if (context.repetition == 0) {
    add_geometry(row, in_model_space(mesh), made.mesh, *scheduler);
    const SurfaceCoverage seen =
        measure_coverage(made.report.views.visible_points, made.mesh, mesh.transform, made.report.spacing, *scheduler);
    row["coverage"] = 100 * seen.share;
    row["visible_rms"] = 100 * resolved(seen.rms * mesh.transform.scale / diagonal_of(in_model_space(mesh)));
    check_cancelled(context);
    if (config.backend == "soft")
      same = same && hash == hash_of(reconstruct(mesh, config, *make_serial_scheduler()).mesh);
  }
  row["same"] = same;
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

}  // namespace

Experiment reconstruct_experiment() {
  return {"reconstruct", "What do levels from position maps cost, and how much of the surface do they keep?",
          true,          parameters(),
          columns(),     run,
          verify};
}

}  // namespace lodestone
