#include "experiments/subjects/reconstruct.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/mesh/raw_mesh.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/metrics/drawn/position_resolution.h"
#include "experiments/subjects/compare.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/load.h"
#include "parallel/scheduler/clock.h"
#include "render/position_map/map_files.h"
#include "render/reconstruct/finish/resample_attributes.h"
#include "render/reconstruct/from_maps.h"
#include "render/reconstruct/views/choose_views.h"

namespace lodestone {
namespace {

class ReconstructRun {
 public:
  ReconstructRun(const ReconstructJob& job, Scheduler& scheduler)
      : job_(job), scheduler_(scheduler), config_(job.config) {
    config_.keep_maps = !job.maps.empty();
  }

  ReconstructResults run() {
    if (is_map_set(job_.input)) {
      from_maps();
      return std::move(results_);
    }
    read();
    if (job_.distance > 0) config_.resolution = resolution_at_distance(mesh_, job_.distance);
    for (int level = 0; level < job_.levels; ++level) make_level(level);
    return std::move(results_);
  }

 private:
  void read() {
    job_.on_phase("reading");
    ReadConfig reading = job_.reading;
    reading.attributes = config_.attributes;
    const CpuClock clock;
    mesh_ = prepare_mesh(load_mesh(job_.input, scheduler_, reading), results_.repairs, scheduler_, job_.input);
    results_.input_triangles = mesh_.triangles.size();
    results_.up = mesh_.transform.up;
    results_.read = clock.elapsed();
  }

  void from_maps() {
    if (job_.measure || job_.distance > 0 || job_.levels > 1 || config_.keep_maps || config_.attributes)
      throw InputError(describe(job_.input, "",
                                "position maps do not have a surface to measure, to sample or to draw again",
                                "leave out --measure, --distance, --levels, --maps and --attributes"));
    job_.on_phase("reading");
    const CpuClock clock;
    Reconstruction made;
    DrawnMaps drawn = drawn_maps(read_map_set(job_.input), made.report);
    if (job_.reading.up)
      for (PositionMap& map : drawn.maps) map.transform.up = {*job_.reading.up, false};
    const Transform transform = drawn.maps.front().transform;
    results_.up = transform.up;
    if (job_.map_resolution > 0) sample_maps_at(job_.map_resolution, drawn, made.report);
    config_.triangles = job_.triangles;
    job_.on_phase("reconstructing");
    made.mesh = mesh_from_maps(drawn, nullptr, config_, made.report, scheduler_);
    config_.resolution = 1 / made.report.spacing;
    finish(made, transform, clock.elapsed(), 0);
  }

  // Maps cannot be finer than they were drawn.
  void sample_maps_at(double resolution, DrawnMaps& drawn, ReconstructReport& report) const {
    if (1 / resolution < 0.999 * report.spacing)
      throw InputError(describe(
          job_.input, "",
          "the maps have " + std::to_string(std::lround(1 / report.spacing)) + " pixels along the longest side",
          "give a --resolution of at most that"));
    drawn.spacing = report.spacing;
    report.spacing = 1 / resolution;
  }

  void make_level(int level) {
    job_.on_phase("reconstructing");
    const CpuClock clock;
    Reconstruction made;
    if (job_.triangles > 0 && level == 0) {
      made = reconstruct_to_triangles(mesh_, config_, job_.triangles, scheduler_);
      config_.resolution = 1 / made.report.spacing;
    } else {
      made = reconstruct(mesh_, config_, scheduler_);
    }
    finish(made, mesh_.transform, clock.elapsed(), level);
    if (config_.keep_maps && level == 0)
      write_map_set(job_.maps, *made.maps, {made.report.closed, made.report.oriented}, job_.map_format);
    config_.resolution /= 2;
  }

  // Writes and measures the mesh.
  void finish(const Reconstruction& made, const Transform& transform, StageTime time, int level) {
    if (made.mesh.triangles.empty())
      throw InputError(describe(job_.input, "", "no view sees three neighbouring samples of a surface",
                                "give a higher --resolution"));
    ReconstructResult result = result_of(made, transform);
    result.file = level_file(job_.output, level);
    result.resolution = config_.resolution;
    result.input_triangles = results_.input_triangles;
    result.time = time;
    const RawMesh split = split_wedges(made.mesh);
    result.warnings = write_mesh(result.file, split);
    result.wedges = split.positions.size();
    if (job_.measure) {
      job_.on_phase("comparing");
      measure(result, made, mesh_, scheduler_);
    }
    result.peak_bytes = peak_resident_bytes();
    job_.on_level(result);
    results_.levels.push_back(std::move(result));
  }

  const ReconstructJob& job_;
  Scheduler& scheduler_;
  ReconstructConfig config_;
  IndexedMesh mesh_;
  ReconstructResults results_;
};

using enum ColumnInfo::Kind;

std::function<Row(const ReconstructResult&)> seconds_of(StageTime ReconstructReport::*stage) {
  return [stage](const ReconstructResult& result) { return Row((result.report.*stage).seconds); };
}

// In % of the diagonal.
Row rms_of(const ReconstructResult& result, const std::optional<SurfaceCoverage>& coverage) {
  if (!coverage || !(result.error->distance.diagonal > 0)) return {};
  return 100 * resolved(coverage->rms * result.scale / result.error->distance.diagonal);
}

const std::vector<Column<ReconstructResult>>& all_reconstruct_columns() {
  using R = const ReconstructResult&;
  static const std::vector<Column<ReconstructResult>> list{
      {{"input_triangles", "", "triangles of the input", count},
       [](R r) { return r.input_triangles > 0 ? Row(r.input_triangles) : Row(); }},
      {{"triangles", "", "triangles of the result", count}, [](R r) { return r.triangles; }},
      {{"vertices", "", "vertices of the result", count}, [](R r) { return r.vertices; }},
      {{"pixels", "", "pixels of all maps", count}, [](R r) { return r.report.pixels; }},
      {{"view_count", "", "views that were drawn", count},
       [](R r) { return r.report.views.directions.size() + r.report.views.inside.size(); }},
      {{"inside_views", "", "views whose near plane lies beyond what is in the way", count},
       [](R r) { return r.report.views.inside.size(); }},
      {{"view_triangles", "", "triangles of all views' meshes, before they are merged", count},
       [](R r) { return r.report.view_triangles; }},
      {{"seen_coverage", "%",
        "share of the pixels of pictures from all directions whose point has the result within a sample's spacing",
        accuracy},
       [](R r) { return r.seen ? Row(100 * r.seen->share) : Row(); }},
      {{"seen_rms", "% of the diagonal",
        "distance from the result of what pixels of pictures from all directions show, root of the mean square",
        accuracy},
       [](R r) { return rms_of(r, r.seen); }},
      {{"coverage", "%",
        "share of the surface that any of 582 directions sees from outside that has the result within a sample's "
        "spacing, however few see it",
        accuracy},
       [](R r) { return r.coverage ? Row(100 * r.coverage->share) : Row(); }},
      {{"visible_rms", "% of the diagonal", "distance of that surface from the result, root of the mean square",
        accuracy},
       [](R r) { return rms_of(r, r.coverage); }},
      {{"border_edges", "", "border edges of the result", count}, [](R r) { return r.quality.border_edges; }},
      {{"manifold", "", "no edge has more than two triangles, no vertex more than one fan", label},
       [](R r) { return r.quality.manifold(); }},
      {{"closed", "", "the result has no border", label}, [](R r) { return r.quality.closed(); }},
      {{"euler", "", "Euler characteristic of the result", quality}, [](R r) { return r.quality.euler; }},
      {{"holes_filled", "", "holes between the views that were filled", count},
       [](R r) { return r.report.stitch.holes_filled; }},
      {{"input_closed", "", "the input has no border", label}, [](R r) { return r.report.closed; }},
      {{"seconds", "s", "from the mesh to the new one", cost}, [](R r) { return r.time.seconds; }},
      {{"cpu_seconds", "s", "processor time from the mesh to the new one, all threads", cost},
       [](R r) { return r.time.cpu_seconds; }},
      {{"views_seconds", "s", "choosing views", cost}, seconds_of(&ReconstructReport::choose)},
      {{"draw_seconds", "s", "drawing the maps", cost}, seconds_of(&ReconstructReport::draw)},
      {{"connect_seconds", "s", "connecting pixels", cost}, seconds_of(&ReconstructReport::connect)},
      {{"merge_seconds", "s", "merging the views", cost}, seconds_of(&ReconstructReport::merge)},
      {{"sharpen_seconds", "s", "recovering sharp features", cost}, seconds_of(&ReconstructReport::sharpen_time)},
      {{"simplify_seconds", "s", "simplifying to the resolution", cost}, seconds_of(&ReconstructReport::simplify)},
      {{"mpixels_per_core_second", "million/s", "pixels of the maps over processor seconds", cost},
       [](R r) { return static_cast<double>(r.report.pixels) * 1e-6 / std::max(r.time.cpu_seconds, 1e-9); }},
      {{"peak_bytes", "bytes", "largest resident set", cost}, [](R r) { return r.peak_bytes; }},
  };
  return list;
}

}  // namespace

MergeKind merge_kind(const std::string& name) {
  if (name == "stitch") return MergeKind::stitch;
  if (name == "concatenate") return MergeKind::concatenate;
  throw InputError("--merge: '" + name + "' is neither stitch nor concatenate");
}

Projection projection_kind(const std::string& name) {
  if (name == "orthographic") return Projection::orthographic;
  if (name == "perspective") return Projection::perspective;
  throw InputError("--projection: '" + name + "' is neither orthographic nor perspective");
}

std::string level_file(const std::string& output, int level) {
  if (level == 0) return output;
  const std::filesystem::path path(output);
  return (path.parent_path() / (path.stem().string() + "." + std::to_string(level) + path.extension().string()))
      .string();
}

ReconstructResults run(const ReconstructJob& job, Scheduler& scheduler) { return ReconstructRun(job, scheduler).run(); }

ReconstructResult result_of(const Reconstruction& made, const Transform& transform) {
  ReconstructResult result;
  result.scale = transform.scale;
  result.triangles = made.mesh.triangles.size(), result.vertices = made.mesh.positions.size();
  result.report = made.report;
  result.quality = measure_quality(made.mesh.positions, made.mesh.triangles);
  return result;
}

void measure(ReconstructResult& result, const Reconstruction& made, const IndexedMesh& input, Scheduler& scheduler) {
  result.error = geometry_error(in_model_space(input), made.mesh, {}, scheduler);
  // Views that were prescribed do not tell what can be seen; fewer samples than a choice needs give a share.
  std::vector<Vec3d> visible = made.report.views.visible_points;
  if (visible.empty()) visible = choose_views(input, {.samples = 5000}, scheduler).visible_points;
  const auto coverage_of = [&](std::span<const Vec3d> points) {
    return measure_coverage(points, made.mesh, input.transform, made.report.spacing, scheduler);
  };
  result.coverage = coverage_of(visible);
  result.seen = coverage_of(points_in_pictures(input, {}, scheduler));
}

std::vector<ColumnInfo> reconstruct_columns() {
  std::vector<ColumnInfo> list = infos_of(all_reconstruct_columns());
  append(list, geometry_columns());
  return list;
}

Row to_row(const ReconstructResult& result) {
  Row row = row_of(all_reconstruct_columns(), result);
  if (result.error) row.update(to_row(*result.error));
  row["slivers"] = 100 * result.quality.sliver_share();
  return row;
}

}  // namespace lodestone
