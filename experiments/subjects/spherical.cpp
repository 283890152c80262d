#include "experiments/subjects/spherical.h"

#include <algorithm>

#include "experiments/metrics/cost/cost.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/load.h"

namespace lodestone {
namespace {

using enum ColumnInfo::Kind;

double thousand_per_second(std::uint64_t faces, const StageTime& time) {
  return static_cast<double>(faces) * 1e-3 / std::max(time.cpu_seconds, 1e-9);
}

using R = const SphericalResult&;

std::vector<Column<SphericalResult>> surface_columns() {
  return {{{"input_triangles", "", "triangles of the input", count}, [](R r) { return r.input_triangles; }},
          {{"components", "", "parts that are mapped to a sphere each", count},
           [](R r) { return r.report.topology.components; }},
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
           [](R r) { return r.report.colour_psnr; }},
          {{"normal_psnr", "dB", "normals of the decoded images against the input's, over the surface", quality},
           [](R r) { return r.report.normal_bytes > 0 ? Row(r.report.normal_psnr) : Row(); }}};
}

std::vector<Column<SphericalResult>> cost_columns() {
  return {
      {{"pixels", "", "pixels of all images", count}, [](R r) { return r.report.pixels; }},
      {{"finest_vertices", "", "vertices of the finest level, copies at seams included", count},
       [](R r) { return r.mesh.vertex_count(); }},
      {{"base_vertices", "", "vertices of the base mesh", count}, [](R r) { return r.mesh.base_vertices; }},
      {{"file_bytes", "bytes", "size of the file", cost}, [](R r) { return r.size.bytes; }},
      {{"geometry_bytes", "bytes", "part of the file that is not images", cost}, [](R r) { return r.size.geometry; }},
      {{"colour_bytes", "bytes", "images of colours", cost}, [](R r) { return r.report.colour_bytes; }},
      {{"normal_bytes", "bytes", "images of normals", cost}, [](R r) { return r.report.normal_bytes; }},
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
      {{"collapse_cpu_seconds", "s", "processor time of making the result progressive", cost},
       [](R r) { return r.report.collapsing.cpu_seconds; }},
      {{"peak_bytes", "bytes", "largest resident set", cost}, [](R r) { return r.peak_bytes; }}};
}

const std::vector<Column<SphericalResult>>& columns() {
  static const auto list = [] {
    std::vector<Column<SphericalResult>> all = surface_columns();
    for (Column<SphericalResult>& column : cost_columns()) all.push_back(std::move(column));
    return all;
  }();
  return list;
}

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
  result.time = clock.elapsed();
  job.config.on_phase("writing");
  ProgressiveFileConfig file;
  file.compress_glb = job.compress;
  result.size = save_progressive(result.mesh, job.output, file);
  result.peak_bytes = peak_resident_bytes();
  return result;
}

std::vector<ColumnInfo> spherical_columns() { return infos_of(columns()); }

Row to_row(const SphericalResult& result) { return row_of(columns(), result); }

}  // namespace lodestone
