#include "experiments/subjects/spherical.h"

#include <algorithm>
#include <bit>

#include "core/base/error.h"
#include "experiments/metrics/cost/cost.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/load.h"
#include "parallel/scheduler/runner.h"

namespace lodestone {
namespace {

using enum ColumnInfo::Kind;

double thousand_per_second(std::uint64_t faces, const StageTime& time) {
  return static_cast<double>(faces) * 1e-3 / std::max(time.cpu_seconds, 1e-9);
}

using R = const SphericalResult&;

constexpr const char* percent = "% of the diagonal";

std::vector<Column<SphericalResult>> surface_columns() {
  return {{{"input_triangles", "", "triangles of the input", count}, [](R r) { return r.input_triangles; }},
          {{"components", "", "parts that are mapped to a sphere each", count},
           [](R r) { return r.report.topology.components; }},
          {{"left_out_components", "", "smaller components that were left out", count},
           [](R r) { return r.report.left_out; }},
          {{"holes", "", "borders that were filled for the time of the mapping", count},
           [](R r) { return r.report.topology.boundary_loops; }},
          {{"handles", "", "handles that were closed for the time of the mapping", count},
           [](R r) { return r.report.topology.handles; }},
          {{"loop_length", "model units", "length of the loops that handles were cut along, together", accuracy},
           [](R r) { return r.report.topology.loops.total; }},
          {{"efficiency", "", "stretch efficiency of the map to the sphere: 1 without stretch", quality},
           [](R r) { return r.report.efficiency; }},
          {{"flips", "", "triangles turned over on the sphere, exactly", count},
           [](R r) { return r.report.map.sums.flips; }},
          {{"slivers", "", "triangles less than a hundredth of their longest edge high on the sphere", count},
           [](R r) { return r.report.map.sums.slivers; }},
          {{"surface_slivers", "", "such triangles of the surface itself", count},
           [](R r) { return r.report.map.sums.surface_slivers; }},
          {{"cut_length", "model units", "length of the cut on the surface", accuracy},
           [](R r) { return r.report.cut_length; }},
          {{"cut_exposure", "", "share of the sky that is seen from the cut, 0 to 1", accuracy},
           [](R r) { return r.report.cut_exposure; }},
          {{"colour_psnr", "dB", "colours of the decoded images against the input's, over the surface", quality},
           [](R r) { return r.report.colour_bytes > 0 ? Row(r.report.colour_psnr) : Row(); }},
          {{"normal_psnr", "dB", "normals of the decoded images against the input's, over the surface", quality},
           [](R r) { return r.report.normal_bytes > 0 ? Row(r.report.normal_psnr) : Row(); }},
          {{"tangent_angle", "degrees", "mean angle between these normals and those that other viewers show", accuracy},
           [](R r) { return r.tangent.plain_angle > 0 ? Row(r.tangent.angle) : Row(); }},
          {{"plain_angle", "degrees", "the same, if they had the normals of vertices alone", accuracy},
           [](R r) { return r.tangent.plain_angle > 0 ? Row(r.tangent.plain_angle) : Row(); }},
          {{"geometry_image_rms", percent,
            "distance of the geometry images' meshes and the closed surface from each other, root of the mean square",
            accuracy},
           [](R r) { return r.report.geometry_bytes > 0 ? Row(100 * r.report.geometry_rms) : Row(); }},
          {{"geometry_image_max", percent,
            "the largest distance of the geometry images' meshes and the closed surface from each other", accuracy},
           [](R r) { return r.report.geometry_bytes > 0 ? Row(100 * r.report.geometry_max) : Row(); }}};
}

std::vector<Column<SphericalResult>> cost_columns() {
  return {
      {{"pixels", "", "pixels of the images of colours and normals", count}, [](R r) { return r.report.pixels; }},
      {{"geometry_image_samples", "", "samples of geometry images", count},
       [](R r) { return r.report.geometry_samples; }},
      {{"finest_triangles", "", "triangles of the finest level", count}, [](R r) { return r.mesh.triangles.size(); }},
      {{"finest_error", "model units",
        "bound of the distance of the finest level from the surface that was mapped, both ways, with what quantization "
        "adds",
        accuracy},
       [](R r) { return r.size.finest_error * r.mesh.transform.scale; }},
      {{"finest_vertices", "", "vertices of the finest level, copies at seams included", count},
       [](R r) { return r.mesh.vertex_count(); }},
      {{"base_vertices", "", "vertices of the base mesh", count}, [](R r) { return r.mesh.base_vertices; }},
      {{"file_bytes", "bytes", "size of the file", cost}, [](R r) { return r.size.bytes; }},
      {{"geometry_bytes", "bytes", "part of the file that is not images", cost}, [](R r) { return r.size.geometry; }},
      {{"colour_bytes", "bytes", "images of colours", cost}, [](R r) { return r.report.colour_bytes; }},
      {{"normal_bytes", "bytes", "images of normals", cost}, [](R r) { return r.report.normal_bytes; }},
      {{"material_bytes", "bytes", "images of metal, roughness, occlusion and emission", cost},
       [](R r) { return r.report.material_bytes; }},
      {{"tangent_bytes", "bytes", "normal maps for other viewers", cost}, [](R r) { return r.tangent.bytes; }},
      {{"geometry_image_bytes", "bytes", "geometry images", cost}, [](R r) { return r.report.geometry_bytes; }},
      {{"seconds", "s", "all stages, without reading and writing", cost}, [](R r) { return r.time.seconds; }},
      {{"cpu_seconds", "s", "processor time of all stages, all threads", cost}, [](R r) { return r.time.cpu_seconds; }},
      {{"closing_cpu_seconds", "s", "processor time of closing holes and handles", cost},
       [](R r) { return r.report.closing.cpu_seconds; }},
      {{"map_cpu_seconds", "s", "processor time of the map to the sphere, without its collapses", cost},
       [](R r) { return r.report.map.map.cpu_seconds; }},
      {{"map_collapse_cpu_seconds", "s", "processor time of the collapses that the map goes back over", cost},
       [](R r) { return r.report.map.collapse.cpu_seconds; }},
      {{"map_ktri_per_core_second", "thousand/s", "input triangles over map_cpu_seconds", cost},
       [](R r) { return thousand_per_second(r.input_triangles, r.report.map.map); }},
      {{"resample_cpu_seconds", "s", "processor time of making images", cost},
       [](R r) { return r.report.resampling.cpu_seconds; }},
      {{"encode_cpu_seconds", "s", "processor time of encoding images, and decoding them again", cost},
       [](R r) { return r.report.encoding.cpu_seconds; }},
      {{"tangent_cpu_seconds", "s", "processor time of normal maps for other viewers", cost},
       [](R r) { return r.tangent.plain_angle > 0 ? Row(r.tangent.time.cpu_seconds) : Row(); }},
      {{"collapse_cpu_seconds", "s", "processor time of making the result progressive", cost},
       [](R r) { return r.report.collapsing.cpu_seconds; }},
      {{"peak_bytes", "bytes", "largest resident set", cost}, [](R r) { return r.peak_bytes; }}};
}

const std::vector<Column<SphericalResult>>& all_spherical_columns() {
  static const auto list = [] {
    std::vector<Column<SphericalResult>> all = surface_columns();
    for (Column<SphericalResult>& column : cost_columns()) all.push_back(std::move(column));
    return all;
  }();
  return list;
}

// Two steps per pixel of the largest image: off by a quarter of a pixel at most.
std::uint32_t uv_bits(std::uint32_t texture) {
  return std::max(static_cast<std::uint32_t>(std::bit_width(texture)), 8u);
}

// Only the .glb is for other viewers.
bool wants_tangent_maps(const SphericalJob& job) { return job.config.maps.normal && !job.output.ends_with(".lpm"); }

}  // namespace

SphericalResult run(const SphericalJob& job, Scheduler& scheduler) {
  SphericalResult result;
  job.config.on_phase("reading");
  RawMesh raw = load_mesh(job.input, scheduler, job.reading);
  result.warnings = std::move(raw.warnings);
  const IndexedMesh mesh = prepare_mesh(std::move(raw), result.repairs, scheduler, job.input);
  result.input_triangles = mesh.triangles.size();
  const CpuClock clock;
  result.mesh = make_spherical(mesh, job.config, scheduler, result.report);
  for (const std::string& feature : result.report.left_out_features)
    result.warnings.push_back(describe(job.input, "", feature));
  if (wants_tangent_maps(job)) {
    job.config.on_phase("making normal maps for other viewers");
    add_tangent_maps(result.mesh, {job.config.media_type, job.config.quality, job.config.error_points}, scheduler,
                     result.tangent);
  }
  result.time = clock.elapsed();
  job.config.on_phase("writing");
  ProgressiveFileConfig file;
  file.compress_glb = job.compress;
  file.lpm.uv_bits = uv_bits(job.config.texture);
  result.size = save_progressive(result.mesh, job.output, file, runner_over(scheduler));
  result.peak_bytes = peak_resident_bytes();
  return result;
}

std::vector<ColumnInfo> spherical_columns() { return infos_of(all_spherical_columns()); }

Row to_row(const SphericalResult& result) { return row_of(all_spherical_columns(), result); }

}  // namespace lodestone
