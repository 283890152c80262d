// The report as CSV and JSON.
#include <fmt/core.h>

#include <algorithm>

#include "experiments/report/report.h"

namespace lodestone {
namespace {

using nlohmann::json;

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_field(const json& value) {
  if (value.is_null()) return "";
  return csv_field(value.is_string() ? value.get<std::string>() : value.dump());
}

void add_name(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

std::string row_state(const RunRecord& run, const Repetition& repetition) {
  if (repetition.fault) return repetition.fault->kind == "verify" ? "unverified" : repetition.fault->kind;
  return state_of(run) == RunState::unverified ? "unverified" : "verified";
}

const char* state_name(RunState state) {
  switch (state) {
    case RunState::complete:
      return "complete";
    case RunState::incomplete:
      return "incomplete";
    case RunState::unverified:
      return "unverified";
    case RunState::failed:
      return "failed";
    case RunState::missing:
      return "missing";
  }
  return "";
}

json to_json(const SettingCell& cell) {
  if (cell.count < 2 && cell.least == cell.most) return cell.value;
  if (!cell.value.is_number()) return cell.value;
  return {{"median", cell.value}, {"least", cell.least}, {"most", cell.most}, {"count", cell.count}};
}

json to_json(const RunRecord& run) {
  json repetitions = json::array();
  for (const Repetition& r : run.repetitions) {
    json entry = {{"repetition", r.number}, {"manifest", r.manifest}};
    if (r.has_rows) entry["rows"] = r.rows;
    if (r.fault) entry["fault"] = {{"kind", r.fault->kind}, {"messages", r.fault->messages}};
    repetitions.push_back(std::move(entry));
  }
  return {{"id", run.id},
          {"data", run.data},
          {"parameters", run.parameters},
          {"program", run.program},
          {"input", run.input},
          {"input_sha256", run.input_sha256},
          {"state", state_name(state_of(run))},
          {"unsteady", run.unsteady},
          {"repetitions", repetitions}};
}

json to_json(const SweepRecord& sweep, const SettingTable& table) {
  json runs = json::array(), settings = json::array();
  for (const RunRecord& run : sweep.runs) runs.push_back(to_json(run));
  for (const SettingRow& setting : table.settings) {
    json values = json::object();
    for (const auto& [name, cell] : setting.cells) values[name] = to_json(cell);
    settings.push_back({{"run", sweep.runs[setting.run].id}, {"values", values}});
  }
  return {{"name", sweep.name},
          {"experiment", sweep.experiment},
          {"question", sweep.question},
          {"runs", runs},
          {"settings", settings}};
}

}  // namespace

std::string to_csv(const Report& report) {
  std::vector<std::string> parameters, columns;
  for (const StudyReport& entry : report.studies)
    for (const SweepRecord& sweep : entry.study.sweeps) {
      for (const ParameterInfo& p : sweep.parameters) add_name(parameters, p.name);
      for (const ColumnInfo& c : sweep.columns) add_name(columns, c.name);
    }
  std::string csv = "study,sweep,experiment,run,data,repetition,state";
  for (const auto* names : {&parameters, &columns})
    for (const std::string& name : *names) {
      // An experiment may set what another one measures.
      const bool taken = names == &parameters && std::find(columns.begin(), columns.end(), name) != columns.end();
      csv.append(1, ',').append(csv_field(taken ? "parameter." + name : name));
    }
  csv += "\n";
  for (const StudyReport& entry : report.studies)
    for (const SweepRecord& sweep : entry.study.sweeps)
      for (const RunRecord& run : sweep.runs)
        for (const Repetition& repetition : run.repetitions)
          for (const Row& row : repetition.rows) {
            csv += fmt::format("{},{},{},{},{},{},{}", csv_field(entry.study.name), csv_field(sweep.name),
                               csv_field(sweep.experiment), run.id, csv_field(run.data), repetition.number,
                               csv_field(row_state(run, repetition)));
            for (const std::string& name : parameters)
              csv.append(1, ',').append(csv_field(run.parameters.value(name, json())));
            for (const std::string& name : columns) csv.append(1, ',').append(csv_field(row.value(name, json())));
            csv += "\n";
          }
  return csv;
}

json to_json(const Report& report) {
  json studies = json::array();
  for (const StudyReport& entry : report.studies) {
    json sweeps = json::array(), figures = json::array();
    for (std::size_t i = 0; i < entry.tables.size(); ++i)
      sweeps.push_back(to_json(entry.study.sweeps[i], entry.tables[i]));
    for (const Figure& figure : entry.figures) figures.push_back(to_json(figure));
    studies.push_back({{"name", entry.study.name},
                       {"title", entry.study.title},
                       {"question", entry.study.question},
                       {"program", entry.study.program},
                       {"oddities", entry.oddities},
                       {"sweeps", sweeps},
                       {"figures", figures}});
  }
  const RunCounts counts = report.counts();
  return {{"runs", counts.runs},
          {"complete", counts.complete},
          {"incomplete", counts.incomplete},
          {"unverified", counts.unverified},
          {"failed", counts.failed},
          {"missing", counts.missing},
          {"studies", studies}};
}

}  // namespace lodestone
