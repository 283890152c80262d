// lodestone experiments: what can be asked, with which parameters, and what comes out.
#include <fmt/core.h>

#include <cmath>

#include "experiments/commands/command.h"
#include "experiments/commands/schema.h"
#include "experiments/studies/experiment.h"
#include "experiments/sweep/column_presence.h"
#include "experiments/sweep/plan.h"

namespace lodestone {
namespace {

// "1 to 8", "at least 1", or nothing.
std::string range_text(const ParameterInfo& info) {
  if (!info.default_value.is_number()) return {};
  const bool low = std::isfinite(info.least), high = std::isfinite(info.most);
  if (low && high) return fmt::format("{:g} to {:g}", info.least, info.most);
  if (low) return fmt::format("at least {:g}", info.least);
  return high ? fmt::format("at most {:g}", info.most) : "";
}

std::string values_text(const ParameterInfo& info) {
  const std::string texts = known_texts(info);
  return texts.empty() ? range_text(info) : texts;
}

Json parameter_json(const ParameterInfo& info) {
  Json json = {{"name", info.name},
               {"default", info.default_value},
               {"unit", info.unit},
               {"description", info.description},
               {"choices", info.choices}};
  if (info.others) json["other_texts"] = info.others->what;
  if (info.default_value.is_number() && std::isfinite(info.least)) json["least"] = info.least;
  if (info.default_value.is_number() && std::isfinite(info.most)) json["most"] = info.most;
  return json;
}

Json experiment_json(const Experiment& experiment) {
  Json json = {{"name", experiment.name},
               {"question", experiment.question},
               {"takes_input", experiment.takes_input},
               {"parameters", Json::array()},
               {"columns", Json::array()}};
  for (const ParameterInfo& info : experiment.parameters) json["parameters"].push_back(parameter_json(info));
  for (const ColumnInfo& column : experiment.columns) json["columns"].push_back(to_json(column));
  return json;
}

void print(const Experiment& experiment) {
  fmt::print("{}: {}\n", experiment.name, experiment.question);
  if (!experiment.takes_input) fmt::print("takes no data\n");
  fmt::print("\n{:<20} {:<16} {:<14} {}\n", "parameter", "default", "unit", "meaning");
  for (const ParameterInfo& info : experiment.parameters) {
    const std::string values = values_text(info);
    fmt::print("{:<20} {:<16} {:<14} {}{}\n", info.name, info.default_value.dump(), info.unit, info.description,
               values.empty() ? "" : " (" + values + ")");
  }
  fmt::print("\n{:<20} {:<16} {:<14} {}\n", "column", "kind", "unit", "meaning");
  for (const ColumnInfo& column : experiment.columns)
    fmt::print("{:<20} {:<16} {:<14} {}{}\n", column.name, to_json(column).at("kind").get<std::string>(), column.unit,
               column.meaning, column.needs.empty() ? "" : " (" + needs_text(column) + ")");
}

struct ExperimentsOptions {
  std::string name;
  bool schema = false;
};

void run(const ExperimentsOptions& options, const CommonOptions& common) {
  check_files(common, {});
  const std::string& name = options.name;
  const bool printed = common.prints();
  if (options.schema) {
    fmt::print("{}", schema_text());
    return;
  }
  if (!name.empty()) {
    const Experiment& experiment = find_experiment(name);
    write_result(common, experiment_json(experiment));
    if (printed) print(experiment);
    return;
  }
  Json all = Json::array();
  for (const std::string& known : experiment_names()) {
    const Experiment& experiment = find_experiment(known);
    all.push_back(experiment_json(experiment));
    if (printed) fmt::print("{:<16} {}\n", experiment.name, experiment.question);
  }
  write_result(common, all);
}

OptionTable declare(ExperimentsOptions& o) {
  return {{"NAME", &o.name, "One of them: its parameters and columns"},
          {"--schema", &o.schema, "Print the keys of every command's JSON and the columns of every experiment"}};
}

}  // namespace

void add_experiments(CommandTable& commands) {
  define_command<ExperimentsOptions>(commands,
                                     {"experiments", "List the experiments of sweeps with their questions",
                                      "  lodestone experiments\n"
                                      "  lodestone experiments probe\n"
                                      "  lodestone experiments --json experiments.json\n"
                                      "  lodestone experiments --schema\n"},
                                     declare, run);
}

}  // namespace lodestone
