#include "experiments/sweep/figure_section.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <regex>
#include <set>

#include "core/base/known_names.h"
#include "experiments/sweep/column_presence.h"
#include "experiments/sweep/name_lists.h"

namespace lodestone {
namespace {

// `measured`: the names are nothing without numbers.
void check_names(TomlTable& table, const char* key, const std::vector<std::string>& given, const FigureSpec& figure,
                 bool measured, SweepFile& file) {
  for (const SweepSection& sweep : file.sweeps) {
    if (std::find(figure.sweep.begin(), figure.sweep.end(), sweep.name) == figure.sweep.end()) continue;
    const std::set<std::string> known = figure_names(*sweep.experiment);
    for (const std::string& name : given) {
      if (!known.contains(name))
        table.fail(*table.find(key), key,
                   fmt::format("'{}' is neither a parameter nor a column of {} (sweep {}); {}", name,
                               sweep.experiment->name, sweep.name, known_names(name, {known.begin(), known.end()})));
      if (measured) check_presence(table, key, name, sweep, "figure '" + figure.title + "'", file);
    }
  }
}

void one_of(TomlTable& table, const char* key, std::string& to, const std::vector<std::string>& choices) {
  table.text(key, to);
  if (table.has(key) && std::find(choices.begin(), choices.end(), to) == choices.end())
    table.fail(*table.find(key), key, "must be one of " + joined(choices));
}

// "<= 0.5": a comparison and its number; none: any other value.
std::optional<std::pair<std::string, double>> comparison_in(const Json& wanted) {
  static const std::regex pattern("(<=|>=|<|>)\\s*(\\S+)");
  std::smatch match;
  const std::string text = wanted.is_string() ? wanted.get<std::string>() : "";
  if (!std::regex_match(text, match, pattern)) return {};
  char* end = nullptr;
  const std::string number = match[2];
  const double value = std::strtod(number.c_str(), &end);
  if (*end != 0 || !std::isfinite(value)) return {};
  return {{match[1], value}};
}

bool holds(const Json& value, const Json& wanted) {
  const auto comparison = comparison_in(wanted);
  if (!comparison) return value == wanted;
  if (!value.is_number()) return false;
  const double a = value.get<double>(), b = comparison->second;
  const std::string& sign = comparison->first;
  return sign == "<" ? a < b : sign == "<=" ? a <= b : sign == ">" ? a > b : a >= b;
}

Json where_value(const toml::node& node, const std::string& name, const TomlTable& table) {
  if (node.is_boolean()) return node.as_boolean()->get();
  if (node.is_integer()) return node.as_integer()->get();
  if (node.is_floating_point() && std::isfinite(node.as_floating_point()->get()))
    return node.as_floating_point()->get();
  if (!node.is_string())
    table.fail(node, "where", name + " must be a number, a text or a truth value; or a comparison, as \"<= 0.5\"");
  const Json text = node.as_string()->get();
  const std::string start = text.get<std::string>().substr(0, 1);
  if ((start == "<" || start == ">") && !comparison_in(text))
    table.fail(node, "where", name + " must be compared with a number, as \"<= 0.5\"");
  return text;
}

void read_where(TomlTable& table, FigureSpec& figure, SweepFile& file) {
  const toml::node* node = table.find("where");
  if (!node) return;
  if (!node->is_table()) table.fail(*node, "where", "must be a table, as { camera = \"orbit\", psnr = \">= 40\" }");
  for (const auto& [key, value] : *node->as_table()) {
    const std::string name(key.str());
    check_names(table, "where", {name}, figure, false, file);
    figure.where[name] = where_value(value, name, table);
  }
}

std::vector<const SweepSection*> sweeps_of(const FigureSpec& figure, const SweepFile& file) {
  std::vector<const SweepSection*> of_figure;
  for (const SweepSection& sweep : file.sweeps)
    if (std::ranges::find(figure.sweep, sweep.name) != figure.sweep.end()) of_figure.push_back(&sweep);
  return of_figure;
}

// Known before anything is measured: a parameter, "data" or "sweep".
bool is_set(const std::string& name, const SweepSection& sweep) {
  const std::vector<ParameterInfo>& parameters = sweep.experiment->parameters;
  return name == "data" || name == "sweep" ||
         std::ranges::find(parameters, name, &ParameterInfo::name) != parameters.end();
}

std::string differing_names(const Json& a, const Json& b) {
  std::vector<std::string> names;
  for (const auto& [name, value] : a.items())
    if (!b.contains(name) || b.at(name) != value) names.push_back("'" + name + "'");
  return joined(names);
}

// Curves and bars over a parameter: settings at one place must differ in the seed of chance alone. What a figure over
// something measured would mix is seen when it is drawn.
void refuse_pooling(TomlTable& table, const FigureSpec& figure, const SweepFile& file) {
  if (figure.kind == "scatter") return;
  std::vector<std::string> names = figure.series;
  names.push_back(figure.x);
  const std::vector<const SweepSection*> sweeps = sweeps_of(figure, file);
  for (const SweepSection* sweep : sweeps)
    for (const std::string& name : names)
      if (!is_set(name, *sweep)) return;
  std::map<Json, Json> first_at;
  for (const SweepSection* sweep : sweeps)
    for (const Json& given : sweep->settings)
      for (const std::string& data : sweep->experiment->takes_input ? sweep->data : std::vector<std::string>{""}) {
        Json setting = Parameters(sweep->experiment->parameters, given).json();
        setting["data"] = data, setting["sweep"] = sweep->name;
        const auto is_kept = [&](const auto& entry) {
          return !setting.contains(entry.first) || holds(setting[entry.first], entry.second);
        };
        if (!std::ranges::all_of(figure.where, is_kept)) continue;
        Json place;
        for (const std::string& name : names) place.push_back(setting[name]), setting.erase(name);
        setting.erase("seed");
        const auto [known, is_new] = first_at.try_emplace(place, setting);
        if (is_new || known->second == setting) continue;
        table.fail(*table.find("x"), "x",
                   fmt::format("has settings at one place that differ in {}; name what parts them in series, or choose "
                               "by where, as where = {{ name = value }}",
                               differing_names(setting, known->second)));
      }
}

}  // namespace

FigureSpec read_figure(TomlTable& table, const toml::node& at, SweepFile& file) {
  FigureSpec figure;
  table.text("title", figure.title);
  figure.sweep = texts(table, "sweep");
  table.text("x", figure.x);
  figure.y = texts(table, "y");
  figure.series = texts(table, "series");
  one_of(table, "kind", figure.kind, {"line", "scatter", "bar"});
  one_of(table, "log", figure.log, {"x", "y", "xy"});
  table.text("mark", figure.mark);
  table.flag("pareto", figure.pareto);
  if (figure.title.empty() || figure.sweep.empty() || figure.x.empty() || figure.y.empty())
    table.fail_at(at.source(), "needs title, sweep, x and y");
  for (const std::string& name : figure.sweep)
    if (std::ranges::find(file.sweeps, name, &SweepSection::name) == file.sweeps.end())
      table.fail(*table.find("sweep"), "sweep", "'" + name + "' is not a sweep of this file");
  read_where(table, figure, file);
  check_names(table, "x", {figure.x}, figure, true, file);
  check_names(table, "y", figure.y, figure, true, file);
  check_names(table, "series", figure.series, figure, false, file);
  if (!figure.mark.empty()) check_names(table, "mark", {figure.mark}, figure, true, file);
  refuse_pooling(table, figure, file);
  return figure;
}

}  // namespace lodestone
