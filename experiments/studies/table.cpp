// Experiment `table`: hierarchies of large models from file to file, within a limit of memory, as a published table has
// them. What is published of a model of that size stands beside as a text: a parameter, so that nobody takes it for a
// measurement.
#include <algorithm>
#include <filesystem>

#include "core/base/error.h"
#include "core/hierarchy/verify/verify.h"
#include "experiments/command_line/version.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/studies/catalogue.h"
#include "experiments/studies/result_hash.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/row_verdict.h"
#include "experiments/studies/study_input.h"
#include "parallel/build/save.h"
#include "parallel/out_of_core/build_model.h"
#include "render/lod/radii.h"

namespace lodestone {
namespace {

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{
      threads_parameter(),
      {"model", "the input", "", "what the input stands for", 0, 0, {}},
      {"published", "not known", "", "what is published of a model of this size", 0, 0, {}},
      {"memory_limit", 0.0, "GiB", "what needs more is built out of core; 0: no limit", 0, 1e6, {}},
  };
  append(list, build_parameters());
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  return {
      {"vertices", "", "of the input", count},
      {"triangles", "", "of the input", count},
      {"levels", "", "of the hierarchy", count},
      {"hlod_vertices", "", "of all levels, a copy for each cell", count},
      {"hlod_triangles", "", "of all levels", count},
      {"bytes", "bytes", "of the file, not compressed", cost},
      {"out_of_core", "", "built on disk, as the limit demands", label},
      {"scratch_bytes", "bytes", "of temporary files", cost},
      {"seconds", "s", "from file to file: reading, building, writing", cost},
      {"cpu_seconds", "s", "processor time of all threads", cost},
      {"read_seconds", "s",
       "of seconds: from the file to a mesh that is welded and clean; out of core to what of the "
       "file is to be welded and dropped",
       cost},
      {"build_seconds", "s",
       "of seconds: from there to packed levels; out of core with everything that goes through "
       "temporary files meanwhile",
       cost},
      {"spill_seconds", "s",
       "of build_seconds, out of core: reading the input again and sorting its triangles by "
       "cells into a temporary file",
       cost},
      {"write_seconds", "s", "of seconds: writing the file; out of core from temporary ones", cost},
      {"build_cpu_seconds", "s", "processor time of building, all threads", cost},
      {"mtri_per_core_second", "million/s", "input triangles over processor seconds of building", cost},
      {"mtri_per_core_second_file", "million/s", "input triangles over processor seconds from file to file", cost},
      {"peak_memory", "bytes", "largest resident set", cost},
      {"rho", "", "reach: the least uniform kappa0 that is admissible", accuracy},
      {"e", "", "largest error of a level over its cell size, as the builder estimates it", accuracy},
      {"fingerprint", "", "of the triangles of the input", label},
      {"valid", "", "the file has every property that verify checks", label},
      {"failed_checks", "", "of verify", label},
  };
}

// The scratch file of a run, gone however the run ends.
class ScratchFile {
 public:
  explicit ScratchFile(const RunContext& context) : path_(std::filesystem::path(context.directory) / "scratch.lode") {}
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::uint64_t limit_of(const Parameters& parameters) {
  return static_cast<std::uint64_t>(parameters.number("memory_limit") * 0x1p30);
}

ModelResult build_to_file(const ModelSource& source, const std::filesystem::path& target, const Parameters& parameters,
                          const RunContext& context, Scheduler& scheduler) {
  ModelConfig config;
  config.build = build_config(parameters, context);
  config.output = target;
  config.memory_limit = limit_of(parameters);
  config.program = std::string(program_version());
  config.progress = [&](const ModelProgress& now) { context.progress(now.share); };
  return build_model(source, config, scheduler);
}

void add_costs(Row& row, const ModelSource& source, const ModelResult& built, const Cost& all) {
  const double millions = static_cast<double>(built.hierarchy.provenance.input_triangles) * 1e-6;
  const bool on_disk = source.stream != nullptr;
  const StageTime& building = built.report.total;
  const auto seconds = [&](const char* stage) { return built.report.stages.at(stage).seconds; };
  row["bytes"] = built.file_bytes, row["scratch_bytes"] = built.scratch_bytes, row["out_of_core"] = on_disk;
  row["seconds"] = all.seconds, row["cpu_seconds"] = all.cpu_seconds, row["peak_memory"] = all.peak_memory;
  row["read_seconds"] = on_disk ? seconds("clean") : seconds("read") + seconds("weld");
  row["write_seconds"] = seconds("write");
  row["build_seconds"] = building.seconds, row["build_cpu_seconds"] = building.cpu_seconds;
  row["spill_seconds"] = on_disk ? Row(seconds("spill")) : Row();
  row["mtri_per_core_second"] = millions / building.cpu_seconds;
  row["mtri_per_core_second_file"] = millions / all.cpu_seconds;
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  if (context.input.empty()) throw InputError("the run has no input; name data in its sweep");
  const auto scheduler = study_scheduler(parameters);
  const ScratchFile file(context);
  const CostMeter meter;
  const ModelSource source = open_model_source(context.input, study_reading(), limit_of(parameters));
  ModelResult built = build_to_file(source, file.path(), parameters, context, *scheduler);
  const Cost cost = meter.elapsed();

  const Hierarchy& tables = built.hierarchy;
  Row row;
  std::uint64_t triangles = 0, vertices = 0;
  float error = 0;
  for (const Level& level : tables.levels) {
    triangles += level.triangles, vertices += level.vertices;
    error = std::max(error, level.error);
  }
  row["vertices"] = tables.provenance.input_vertices, row["triangles"] = tables.provenance.input_triangles;
  row["levels"] = tables.levels.size(), row["hlod_vertices"] = vertices, row["hlod_triangles"] = triangles;
  add_costs(row, source, built, cost);
  row["fingerprint"] = to_hex(tables.provenance.fingerprint);
  if (context.repetition > 0) return {row};
  row["rho"] = reach(tables, DistanceMetric::euclidean), row["e"] = error;
  built.hierarchy = {};
  check_cancelled(context);
  const VerifyReport report = verify_hierarchy(load_lode(file.path(), *scheduler));
  row["valid"] = report.valid(), row["failed_checks"] = failed_checks(report);
  return {row};
}

std::vector<SettingFault> check(const Parameters& parameters) {
  SettingVerdict verdict;
  check_build(verdict, parameters);
  return std::move(verdict).faults();
}

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.present("fingerprint");
  verdict.is_true("valid");
  verdict.in_order("triangles", "hlod_triangles");
  verdict.in_order("spill_seconds", "build_seconds");
  verdict.in_order("build_cpu_seconds", "cpu_seconds");
  for (const Row& row : rows) {
    const auto seconds = [&](const char* column) { return number_in(row, column).value_or(0); };
    verdict.require(seconds("seconds") > 0, "seconds is missing or not positive");
    verdict.require(seconds("read_seconds") + seconds("build_seconds") + seconds("write_seconds") <= seconds("seconds"),
                    "reading, building and writing took longer than all together");
    verdict.require(text_in(row, "failed_checks").empty(), "failed checks: " + text_in(row, "failed_checks"));
    if (row.value("out_of_core", false))
      verdict.require(number_in(row, "peak_memory").value_or(0) <= parameters.number("memory_limit") * 0x1p30,
                      "the build took more memory than the limit");
  }
  return std::move(verdict).messages();
}

}  // namespace

Experiment table_experiment() {
  return {"table",   "What do hierarchies of the published sizes take, in triangles, seconds and memory?",
          true,      parameters(),
          columns(), run,
          verify,    check};
}

}  // namespace lodestone
