#include "experiments/sweep/plan.h"

#include <algorithm>
#include <charconv>

#include "core/base/error.h"
#include "experiments/sweep/program_identity.h"
#include "experiments/sweep/sha256.h"

namespace lodestone {
namespace {

const char* kind_name(ColumnInfo::Kind kind) {
  switch (kind) {
    case ColumnInfo::Kind::label:
      return "label";
    case ColumnInfo::Kind::accuracy:
      return "accuracy";
    case ColumnInfo::Kind::quality:
      return "quality";
    case ColumnInfo::Kind::cost:
      return "cost";
    case ColumnInfo::Kind::count:
      return "count";
  }
  return "";
}

Json figure_json(const FigureSpec& figure) {
  return {{"title", figure.title},   {"sweep", figure.sweep}, {"x", figure.x},     {"y", figure.y},
          {"series", figure.series}, {"kind", figure.kind},   {"log", figure.log}, {"mark", figure.mark},
          {"pareto", figure.pareto}, {"where", figure.where}};
}

Json data_json(const DataSource& source, const SweepInput& input) {
  Json json = {{"path", input.path}, {"sha256", input.sha256}, {"bytes", input.bytes}};
  if (source.generate)
    json["generate"] = {
        {"shape", source.shape}, {"triangles", source.generate->triangles}, {"seed", source.generate->seed}};
  return json;
}

Json section_json(const SweepSection& section) {
  const Experiment& experiment = *section.experiment;
  Json json = {{"name", section.name},
               {"experiment", experiment.name},
               {"question", experiment.question},
               {"repetitions", section.repetitions},
               {"parameters", Json::array()},
               {"columns", Json::array()},
               {"metrics", section.metrics},
               {"runs", Json::array()}};
  for (const ParameterInfo& info : experiment.parameters)
    json["parameters"].push_back(
        {{"name", info.name}, {"unit", info.unit}, {"description", info.description}, {"condition", info.condition}});
  for (const ColumnInfo& column : experiment.columns) json["columns"].push_back(to_json(column));
  return json;
}

// The runs of one sweep, in the order of the file.
std::vector<SweepRun> section_runs(const SweepSection& section, const ParameterFiles& files,
                                   const std::map<std::string, SweepInput>& inputs) {
  std::vector<SweepRun> runs;
  const std::vector<std::string> none{""};
  for (const Json& setting : section.settings)
    for (const std::string& data : section.experiment->takes_input ? section.data : none) {
      if (!data.empty() && !inputs.contains(data)) continue;
      SweepRun run;
      run.experiment = section.experiment;
      run.program = program_hash();
      run.sweep = section.name;
      run.data = data;
      run.given = setting;
      run.parameters = Parameters(section.experiment->parameters, setting).json();
      run.files = files_of(run.parameters, section.experiment->parameters, files);
      if (!data.empty()) run.input = inputs.at(data);
      run.repetitions = section.repetitions;
      if (data.empty() || !run.input.sha256.empty()) run.id = run_id(run);
      runs.push_back(std::move(run));
    }
  return runs;
}

}  // namespace

Json to_json(const ColumnInfo& column) {
  return {{"name", column.name}, {"unit", column.unit}, {"meaning", column.meaning}, {"kind", kind_name(column.kind)}};
}

std::string run_id(const SweepRun& run) {
  const Json identity = {{"experiment", run.experiment->name},
                         {"parameters", with_hashes(run.parameters, run.files)},
                         {"input", run.input.sha256},
                         {"program", run.program}};
  return sha256(identity.dump()).substr(0, 16);
}

std::set<std::string> data_names(const SweepFile& file) {
  std::set<std::string> names;
  for (const SweepSection& section : file.sweeps) names.insert(section.data.begin(), section.data.end());
  return names;
}

SweepPlan make_plan(const SweepFile& file, const std::map<std::string, SweepInput>& inputs) {
  SweepPlan plan;
  plan.json = {{"name", file.name},
               {"title", file.title},
               {"question", file.question},
               {"form", name_of(file.form)},
               {"program", program_hash()},
               {"data", Json::object()},
               {"files", files_json(file.files)},
               {"figures", Json::array()},
               {"sweeps", Json::array()}};
  const std::set<std::string> names = data_names(file);
  for (const DataSource& source : file.data) {
    if (inputs.contains(source.name))
      plan.json["data"][source.name] = data_json(source, inputs.at(source.name));
    else if (names.contains(source.name))
      plan.left_out[source.name] = missing_file(source).value_or(source.path);
  }
  if (!plan.left_out.empty()) plan.json["left_out"] = plan.left_out;
  for (const FigureSpec& figure : file.figures) plan.json["figures"].push_back(figure_json(figure));
  std::map<std::string, std::size_t> place;  // of a run, by id
  for (const SweepSection& section : file.sweeps) {
    Json json = section_json(section);
    for (SweepRun& run : section_runs(section, file.files, inputs)) {
      json["runs"].push_back({{"id", run.id}, {"data", run.data}, {"parameters", run.parameters}});
      const auto [found, is_new] = place.try_emplace(run.id, plan.runs.size());
      if (is_new || run.id.empty()) {
        plan.runs.push_back(std::move(run));
      } else {
        SweepRun& known = plan.runs[found->second];
        known.repetitions = std::max(known.repetitions, run.repetitions);
      }
    }
    plan.json["sweeps"].push_back(std::move(json));
  }
  return plan;
}

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto [slash, first] = std::from_chars(text.data(), end, shard.index);
  const bool divided = first == std::errc() && slash != end && *slash == '/';
  const auto [rest, second] =
      divided ? std::from_chars(slash + 1, end, shard.count) : std::from_chars_result{slash, first};
  if (!divided || second != std::errc() || rest != end || shard.index < 1 || shard.index > shard.count)
    throw InputError("--shard " + text + ": must be i/n with i from 1 to n, as 2/8");
  return shard;
}

std::vector<SweepRun> runs_of(const SweepPlan& plan, const Shard& shard) {
  std::vector<std::string> ids;
  for (const SweepRun& run : plan.runs) ids.push_back(run.id);
  std::sort(ids.begin(), ids.end());
  std::vector<SweepRun> mine;
  for (const SweepRun& run : plan.runs) {
    const auto rank = std::lower_bound(ids.begin(), ids.end(), run.id) - ids.begin();
    if (rank % shard.count == shard.index - 1) mine.push_back(run);
  }
  return mine;
}

}  // namespace lodestone
