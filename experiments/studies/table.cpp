// Experiment `table`: hierarchies of large models from file to file, within a limit of memory, as a published table has
// them. What is published of a model of that size is given beside it as a text: a parameter, so that nobody takes it
// for a measurement.
#include "core/base/error.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/run_file.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/build.h"
#include "parallel/hierarchy/save.h"

namespace lodestone {
namespace table_study {

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{
      threads_parameter(),
      as_condition({"model", "the input", "", "model that the input represents", 0, 0, {}}),
      as_condition({"published", "not known", "", "what is published of a model of this size", 0, 0, {}}),
      as_condition({"memory_limit", 0.0, "GiB", "what needs more is built out of core; 0: no limit", 0, 1e6, {}}),
  };
  append(list, build_parameters());
  return list;
}

std::vector<ColumnInfo> columns() {
  std::vector<ColumnInfo> list =
      without(build_columns(), {"busy", "idle_tail", "measure_seconds", "measure_cpu_seconds"});
  append(list, verify_columns());
  return list;
}

std::uint64_t memory_limit(const Parameters& parameters) {
  return static_cast<std::uint64_t>(parameters.number("memory_limit") * 0x1p30);
}

std::vector<Row> rows_of(const Parameters& parameters, const RunContext& context) {
  if (context.input.empty()) throw InputError("the run has no input; name data in its sweep");
  const auto scheduler = study_scheduler(parameters);
  const RunFile file(context);
  BuildJob job;
  job.inputs = {context.input};
  job.output = file.path();
  job.reading = study_reading();
  job.build = build_config(parameters, context);
  job.build.progress = context.progress;
  job.memory_limit = memory_limit(parameters);
  Row row;
  {
    const BuildResult result = run(job, *scheduler);
    row = restricted_to(columns(), to_row(result));
  }
  if (context.repetition > 0) return {row};
  check_cancelled(context);
  add_verification(row, load_lode(file.path(), *scheduler), *scheduler);
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
  verdict.in_order("input_triangles", "stored_triangles");
  verdict.in_order("spill_seconds", "seconds");
  verdict.in_order("cpu_seconds", "file_cpu_seconds");
  check_verification(verdict);
  for (const Row& row : rows) {
    const auto seconds = [&](const char* column) { return number_in(row, column).value_or(0); };
    verdict.require(seconds("file_seconds") > 0, "file_seconds is missing or not positive");
    verdict.require(seconds("read_seconds") + seconds("weld_seconds") + seconds("seconds") + seconds("write_seconds") <=
                        seconds("file_seconds"),
                    "reading, building and writing took longer than all together");
    if (row.value("out_of_core", false))
      verdict.require(seconds("peak_bytes") <= static_cast<double>(memory_limit(parameters)),
                      "the build took more memory than the limit");
  }
  return std::move(verdict).messages();
}

}  // namespace table_study

Experiment table_experiment() {
  using namespace table_study;
  return {"table",   "What do hierarchies of the published sizes take, in triangles, seconds and memory?",
          true,      parameters(),
          columns(), rows_of,
          verify,    check};
}

}  // namespace lodestone
