#include "experiments/sweep/column_presence.h"

#include <algorithm>

namespace lodestone {
namespace {

// Columns that the report derives from `seconds` over the numbers of threads, where the experiment has no such columns.
const std::set<std::string> derived{"speedup", "efficiency", "karp_flatt"};

bool has_column(const Experiment& experiment, const std::string& name) {
  return std::ranges::find(experiment.columns, name, &ColumnInfo::name) != experiment.columns.end();
}

bool derives(const Experiment& experiment) {
  return has_column(experiment, "seconds") &&
         std::ranges::find(experiment.parameters, "threads", &ParameterInfo::name) != experiment.parameters.end();
}

Json resolved(const SweepSection& sweep, const Json& setting) {
  return Parameters(sweep.experiment->parameters, setting).json();
}

bool holds(const ColumnNeed& need, const Json& parameters) {
  return std::ranges::any_of(need.any, [&](const ColumnNeed::Condition& condition) {
    return (parameters.at(condition.parameter) == condition.value) == condition.is;
  });
}

std::string text_of(const ColumnNeed& need) {
  std::string text;
  for (const auto& [parameter, value, is] : need.any)
    text += (text.empty() ? "" : " or ") + parameter + (is ? " = " : " to something else than ") + value.dump();
  return text;
}

// One thread, and others to compare with it.
ColumnPresence presence_of_derived(const SweepSection& sweep) {
  std::set<Json> threads;
  for (const Json& setting : sweep.settings) threads.insert(resolved(sweep, setting).at("threads"));
  if (threads.size() > 1 && threads.contains(1)) return {sweep.settings.size(), ""};
  return {0, "set threads to several numbers, 1 among them,"};
}

}  // namespace

std::set<std::string> column_names(const Experiment& experiment) {
  std::set<std::string> names;
  for (const ColumnInfo& column : experiment.columns) names.insert(column.name);
  if (derives(experiment)) names.insert(derived.begin(), derived.end());
  return names;
}

std::set<std::string> figure_names(const Experiment& experiment) {
  std::set<std::string> names = column_names(experiment);
  names.insert({"data", "sweep"});
  for (const ParameterInfo& info : experiment.parameters) names.insert(info.name);
  return names;
}

ColumnPresence presence(const SweepSection& sweep, const std::string& name) {
  const Experiment& experiment = *sweep.experiment;
  const auto column = std::ranges::find(experiment.columns, name, &ColumnInfo::name);
  if (column == experiment.columns.end() && derived.contains(name) && derives(experiment))
    return presence_of_derived(sweep);
  if (column == experiment.columns.end() || column->needs.empty()) return {sweep.settings.size(), ""};
  ColumnPresence found;
  for (const Json& setting : sweep.settings) {
    const Json parameters = resolved(sweep, setting);
    if (std::ranges::all_of(column->needs, [&](const ColumnNeed& need) { return holds(need, parameters); }))
      ++found.settings;
  }
  if (found.settings < sweep.settings.size()) found.remedy = needs_text(*column);
  return found;
}

std::string needs_text(const ColumnInfo& column) {
  std::string text;
  for (const ColumnNeed& need : column.needs) text += (text.empty() ? "set " : " and ") + text_of(need);
  return text;
}

}  // namespace lodestone
