#include "experiments/subjects/build.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/base/error.h"
#include "experiments/command_line/version.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/subjects/result_hash.h"
#include "parallel/mesh/joined_stream.h"
#include "render/lod/radii.h"

namespace lodestone {
namespace {

ModelConfig model_config(const BuildJob& job) {
  ModelConfig config;
  config.build = job.build;
  config.output = job.output;
  config.lattice = job.lattice;
  config.form = job.form;
  config.measure_errors = job.measure_errors;
  config.texture_copies = job.texture_levels;
  config.memory_limit = job.memory_limit;
  config.scratch = job.scratch;
  config.resume = job.resume;
  config.program = std::string(program_version());
  return config;
}

// Measured errors and refinement need all of the mesh or of the hierarchy at once.
void refuse_beyond_limit(const BuildJob& job) {
  for (const auto& [given, name] : {std::pair{job.measure_errors, "--measure-error"}, {job.build.refine, "--refine"}})
    if (given)
      throw InputError(describe(name_of_files(job.inputs), "",
                                std::string(name) + " needs more memory than --memory-limit allows",
                                "leave one of them out"));
}

ScratchUse scratch_use(const ModelConfig& config, const ModelNeed& need) {
  std::filesystem::path folder = scratch_folder(config.output, config.scratch);
  if (!config.resume) folder = folder.has_parent_path() ? folder.parent_path() : ".";
  return {folder.string(), config.resume, need.scratch_bytes};
}

struct Totals {
  std::uint64_t triangles = 0, vertices = 0;
  float diameter = 0, error = 0;
};

Totals totals(const BuildResult& result) {
  Totals sum;
  for (const Level& level : result.hierarchy.levels) {
    sum.triangles += level.triangles, sum.vertices += level.vertices;
    sum.diameter = std::max(sum.diameter, level.diameter), sum.error = std::max(sum.error, level.error);
  }
  return sum;
}

const Provenance& input_of(const BuildResult& result) { return result.hierarchy.provenance; }

double ratio(std::uint64_t a, std::uint64_t b) { return static_cast<double>(a) / static_cast<double>(b); }

std::function<Row(const BuildResult&)> seconds_of(const char* stage) {
  return [stage](const BuildResult& result) {
    for (const auto* stages : {&result.stages, &result.report.stages})
      if (const auto found = stages->find(stage); found != stages->end()) return Row(found->second.seconds);
    return Row();
  };
}

// Reading in memory is a stage of its own; out of core, the stream is read while it is cleaned.
Row read_seconds(const BuildResult& result) { return seconds_of(result.scratch ? "clean" : "read")(result); }

double millions_per(double seconds, const BuildResult& result) {
  return static_cast<double>(input_of(result).input_triangles) * 1e-6 / std::max(seconds, 1e-9);
}

using enum ColumnInfo::Kind;

using Columns = std::vector<Column<BuildResult>>;

Columns size_columns() {
  using R = const BuildResult&;
  return {
      {{"input_triangles", "", "triangles of the input", count}, [](R r) { return input_of(r).input_triangles; }},
      {{"input_vertices", "", "vertices of the input", count}, [](R r) { return input_of(r).input_vertices; }},
      {{"levels", "", "levels of the hierarchy", count}, [](R r) { return r.hierarchy.levels.size(); }},
      {{"cells", "", "cells of the hierarchy", count}, [](R r) { return r.hierarchy.cells.size(); }},
      {{"stored_triangles", "", "triangles of all levels", count}, [](R r) { return totals(r).triangles; }},
      {{"stored_vertices", "", "vertices of all levels, a copy for each cell", count},
       [](R r) { return totals(r).vertices; }},
      {{"stored_ratio", "", "stored triangles over those of the input", cost},
       [](R r) { return ratio(totals(r).triangles, input_of(r).input_triangles); }},
      {{"long_edges", "", "half-edges of the input longer than sigma0 h_L, which cost triangles", count},
       [](R r) { return r.hierarchy.levels.back().long_edges; }},
      {{"max_edge_ratio", "h_L", "longest edge of the input", accuracy},
       [](R r) { return r.hierarchy.levels.back().max_edge; }},
      {{"file_bytes", "bytes", "size of the file", cost}, [](R r) { return r.file_bytes; }},
      {{"bytes_per_stored_triangle", "bytes", "size of the file over its stored triangles", cost},
       [](R r) { return ratio(r.file_bytes, totals(r).triangles); }},
      {{"out_of_core", "", "built on disk, as the limit demands", label}, [](R r) { return r.scratch.has_value(); }},
      {{"scratch_bytes", "bytes", "temporary files", cost}, [](R r) { return r.scratch ? r.scratch->bytes : 0; }},
  };
}

Columns time_columns() {
  using R = const BuildResult&;
  return {
      {{"seconds", "s",
        "building, from the mesh to packed levels; out of core with everything that goes through temporary files "
        "meanwhile",
        cost},
       [](R r) { return r.report.total.seconds; }},
      {{"cpu_seconds", "s", "processor time of building, all threads", cost},
       [](R r) { return r.report.total.cpu_seconds; }},
      {{"file_seconds", "s", "from file to file: reading, building, writing", cost},
       [](R r) { return r.total.seconds; }},
      {{"file_cpu_seconds", "s", "processor time from file to file, all threads", cost},
       [](R r) { return r.total.cpu_seconds; }},
      {{"read_seconds", "s", "reading the input file; out of core with finding what is to be welded and dropped", cost},
       read_seconds},
      {{"weld_seconds", "s", "cleaning, welding and normalising in memory", cost}, seconds_of("weld")},
      {{"partition_seconds", "s", "part of building in memory: assigning triangles to cells", cost},
       seconds_of("partition")},
      {{"spill_seconds", "s",
        "part of building out of core: reading the input again and sorting its triangles by cells into a temporary "
        "file",
        cost},
       seconds_of("spill")},
      {{"hierarchy_seconds", "s", "part of building: simplifying level by level", cost}, seconds_of("hierarchy")},
      {{"measure_seconds", "s", "measuring errors", cost}, seconds_of("measure")},
      {{"measure_cpu_seconds", "s", "processor time of measuring errors, all threads", cost},
       [](R r) { return r.stages.contains("measure") ? Row(r.stages.at("measure").cpu_seconds) : Row(); }},
      {{"write_seconds", "s", "writing the file", cost}, seconds_of("write")},
      {{"mtri_per_core_second", "million/s", "input triangles over processor seconds of building", cost},
       [](R r) { return millions_per(r.report.total.cpu_seconds, r); }},
      {{"file_mtri_per_core_second", "million/s", "input triangles over processor seconds from file to file", cost},
       [](R r) { return millions_per(r.total.cpu_seconds, r); }},
      {{"peak_bytes", "bytes", "largest resident set", cost}, [](R r) { return r.peak_bytes; }},
      {{"busy", "%", "share of the workers' time that lies inside tasks of building", cost},
       [](R r) { return r.use ? Row(100 * r.use->busy) : Row(); }},
      {{"idle_tail", "s", "end of building in which at least one worker has nothing left to do", cost},
       [](R r) { return r.use ? Row(r.use->idle_tail) : Row(); }},
      {{"rho", "", "reach: the least uniform kappa0 that is admissible", accuracy},
       [](R r) { return greatest_reach(r.hierarchy, DistanceMetric::euclidean); }},
      {{"diameter", "", "largest diameter of a cell's box over its size", accuracy},
       [](R r) { return totals(r).diameter; }},
      {{"e", "", "largest error of a level over its cell size, as the builder states it", accuracy},
       [](R r) { return totals(r).error; }},
      {{"fingerprint", "", "hash of the triangles of the input", label},
       [](R r) { return to_hex(input_of(r).fingerprint); }},
  };
}

const Columns& all_build_columns() {
  static const Columns list = [] {
    Columns all = size_columns();
    std::ranges::copy(time_columns(), std::back_inserter(all));
    return all;
  }();
  return list;
}

}  // namespace

BuildResult run(const BuildJob& job, Scheduler& scheduler) {
  const CostMeter meter;
  ModelConfig config = model_config(job);
  const ModelSource source = open_model_source(job.inputs, job.reading, job.memory_limit, scheduler.workers());
  BuildResult result;
  if (source.stream) {
    refuse_beyond_limit(job);
    result.scratch = scratch_use(config, model_need(*source.stream, config, scheduler.workers()));
  }
  config.progress = [&, step = std::string(), begin = 0.0](const ModelProgress& now) mutable {
    if (step.empty() && result.scratch) job.on_scratch(*result.scratch);
    if (step != now.step) {
      if (job.trace && step == "building") result.use = summarize(*job.trace, begin);
      begin = job.trace && !source.stream ? job.trace->now() : 0;
      job.on_phase(step = now.step, static_cast<double>(now.triangles));
    }
    if (job.build.progress) job.build.progress(now.share);
  };
  ModelResult built = build_model(source, config, scheduler);
  const Cost cost = meter.elapsed();
  if (result.scratch)
    result.scratch->bytes = built.scratch_bytes, result.scratch->blocks = built.blocks,
    result.scratch->blocks_resumed = built.blocks_resumed;
  if (job.trace && !result.use) result.use = summarize(*job.trace);
  result.hierarchy = std::move(built.hierarchy);
  result.report = std::move(built.report);
  result.stages = result.report.stages;
  result.file_bytes = built.file_bytes;
  result.attributes = built.attributes;
  result.warnings = std::move(built.warnings);
  result.measured = built.measured;
  result.total = {cost.seconds, cost.cpu_seconds};
  result.peak_bytes = cost.peak_memory;
  return result;
}

std::vector<ColumnInfo> build_columns() { return infos_of(all_build_columns()); }

Row to_row(const BuildResult& result) { return row_of(all_build_columns(), result); }

Json to_json(const AttributeCounts& counts) {
  return {{"wedges", counts.wedges},       {"normals", counts.normals},
          {"colours", counts.colours},     {"texture_coordinates", counts.texture_coordinates},
          {"materials", counts.materials}, {"textures", counts.textures}};
}

Json level_table(const Hierarchy& hierarchy) {
  Json table = Json::array();
  for (const Level& level : hierarchy.levels)
    table.push_back({{"level", table.size()},
                     {"cells", level.cell_count},
                     {"triangles", level.triangles},
                     {"vertices", level.vertices},
                     {"reach", {{"euclidean", level.reach[0]}, {"chebyshev", level.reach[1]}}},
                     {"diameter", level.diameter},
                     {"error_ratio", level.error},
                     {"max_edge_ratio", level.max_edge},
                     {"long_edges", level.long_edges}});
  return table;
}

}  // namespace lodestone
