#include "experiments/subjects/progressive.h"

#include <algorithm>

#include "core/progressive/mesh/level.h"
#include "core/progressive/mesh/texture_meanings.h"
#include "core/texture/recompress.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/metrics/cracks/progressive_cracks.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/load.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/runner.h"

namespace lodestone {
namespace {

using enum ColumnInfo::Kind;

Row size_of(const ProgressiveResult& result, std::size_t ProgressiveFileSize::*part) {
  return result.size ? Row((*result.size).*part) : Row();
}

const std::vector<Column<ProgressiveResult>>& all_progressive_columns() {
  using R = const ProgressiveResult&;
  static const std::vector<Column<ProgressiveResult>> list{
      {{"input_triangles", "", "triangles of the input", count}, [](R r) { return r.report.input_triangles; }},
      {{"finest_triangles", "", "triangles of the finest level", count}, [](R r) { return r.mesh.triangles.size(); }},
      {{"finest_vertices", "", "vertices of the finest level", count}, [](R r) { return r.mesh.vertex_count(); }},
      {{"finest_error", "model units",
        "bound of the distance of the finest level from the input, both ways, with what quantization adds", accuracy},
       [](R r) { return (r.size ? r.size->finest_error : r.mesh.finest_error) * r.mesh.transform.scale; }},
      {{"base_triangles", "", "triangles of the base mesh", count},
       [](R r) { return LevelFinder(r.mesh).triangles_of(r.mesh.base_vertices); }},
      {{"base_vertices", "", "vertices of the base mesh", count}, [](R r) { return r.mesh.base_vertices; }},
      {{"cut_vertices", "", "copies made where the surface is not a manifold", count},
       [](R r) { return r.report.cut_vertices; }},
      {{"cut_edges", "", "edges cut apart where the surface is not a manifold", count},
       [](R r) { return r.report.cut_edges; }},
      {{"seconds", "s", "making the progressive mesh", cost}, [](R r) { return r.time.seconds; }},
      {{"cpu_seconds", "s", "processor time of making it, all threads", cost}, [](R r) { return r.time.cpu_seconds; }},
      {{"ktri_per_core_second", "thousand/s", "input triangles over processor seconds", cost},
       [](R r) { return static_cast<double>(r.report.input_triangles) * 1e-3 / std::max(r.time.cpu_seconds, 1e-9); }},
      {{"file_bytes", "bytes", "size of the file", cost}, [](R r) { return size_of(r, &ProgressiveFileSize::bytes); }},
      {{"geometry_bytes", "bytes", "part of the file that is not images", cost},
       [](R r) { return size_of(r, &ProgressiveFileSize::geometry); }},
      {{"base_bytes", "bytes", "part of the file that has to be there before something can be drawn", cost},
       [](R r) { return size_of(r, &ProgressiveFileSize::base); }},
      // Images are left out, so that textures do not hide the cost of the vertices.
      {{"bytes_per_vertex", "bytes", "geometry_bytes over the number of stored vertices", cost},
       [](R r) {
         return r.size ? Row(static_cast<double>(r.size->geometry) / static_cast<double>(r.mesh.positions.size()))
                       : Row();
       }},
      {{"peak_bytes", "bytes", "largest resident set", cost}, [](R r) { return r.peak_bytes; }},
      {{"residual_edges", "", "cracks: edges of a level's border that are not the image of the input's", count},
       [](R r) { return or_null(r.residual_edges); }},
  };
  return list;
}

}  // namespace

ProgressiveResult run(const ProgressiveJob& job, Scheduler& scheduler) {
  ProgressiveResult result;
  job.on_phase("reading");
  RawMesh raw = load_mesh(job.input, scheduler, job.reading);
  if (!job.normals || !keeps_normals(job.output)) raw.wedges.normal.clear();
  result.warnings = std::move(raw.warnings);
  IndexedMesh mesh = prepare_mesh(std::move(raw), result.repairs, scheduler, job.input);
  job.on_phase("collapsing");
  result.metric = job.metric.value_or(fitting_metric(mesh.wedges));
  ProgressiveConfig config = job.config;
  config.metric = result.metric;
  const CpuClock clock;
  result.mesh = make_progressive(std::move(mesh), config, scheduler, result.report);
  result.time = clock.elapsed();
  if (job.texture_quality > 0) {
    job.on_phase("encoding textures");
    std::vector<Texture>& textures = result.mesh.wedges.textures;
    const auto meanings = texture_meanings(result.mesh);
    scheduler.for_chunks(textures.size(), 1, [&](ChunkRange range) {
      const PixelMeaning meaning = meanings[range.begin].value_or(PixelMeaning::values);
      textures[range.begin] = recompressed(textures[range.begin], meaning, job.texture_quality);
    });
  }
  job.on_phase("writing");
  result.size = save_progressive(result.mesh, job.output, job.file, runner_over(scheduler));
  if (job.check_levels > 0) result.residual_edges = residual_edges_of_levels(result.mesh, job.check_levels);
  result.peak_bytes = peak_resident_bytes();
  return result;
}

std::vector<ColumnInfo> progressive_columns() { return infos_of(all_progressive_columns()); }

Row to_row(const ProgressiveResult& result) { return row_of(all_progressive_columns(), result); }

}  // namespace lodestone
