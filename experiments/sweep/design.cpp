#include "experiments/sweep/design.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

#include "core/base/known_names.h"

namespace lodestone {
namespace {

using Values = std::vector<ParameterValue>;

const ParameterInfo& info_of(const std::vector<ParameterInfo>& known, const std::string& name, const toml::node& at,
                             const TomlTable& table) {
  std::vector<std::string> names;
  for (const ParameterInfo& info : known) {
    if (info.name == name) return info;
    names.push_back(info.name);
  }
  table.fail_at(at.source(), fmt::format("unknown parameter '{}'; {}", name, known_names(name, names)));
}

void look_into(const ParameterInfo& info, const ParameterValue& value, const toml::node& at, const TomlTable& table) {
  try {
    info.others->look_into(beside(table.file(), value.string()));
  } catch (const Error& error) {
    table.fail_at(at.source(), fmt::format("{} = {}: {}; name a good file, relative to that of the sweep", info.name,
                                           value.dump(), error.what()));
  }
}

// In the kind and range of the parameter.
ParameterValue checked(const ParameterInfo& info, const ParameterValue& value, const toml::node& at,
                       const TomlTable& table) {
  ParameterValue usual;
  try {
    usual = Parameters({info}, {{info.name, value}}).json().at(info.name);
  } catch (const InputError& error) {
    table.fail_at(at.source(), error.what());
  }
  if (names_file(info, usual)) look_into(info, usual, at, table);
  return usual;
}

ParameterValue scalar(const ParameterInfo& info, const toml::node& node, const TomlTable& table) {
  ParameterValue value;
  if (const auto* text = node.as_string()) value = text->get();
  if (const auto* flag = node.as_boolean()) value = flag->get();
  if (const auto* whole = node.as_integer()) value = whole->get();
  if (const auto* number = node.as_floating_point()) value = number->get();
  if (value.is_null()) table.fail(node, info.name, "must be a number, a text, or true or false");
  return checked(info, value, node, table);
}

// { from, to, count, scale } of a parameter that is a number.
struct Range {
  double from = 0, to = 0;
  std::int64_t count = 0;  // 0: not given
  bool log = false, whole = false;

  // At `share` in [0, 1] of the way. Digits that only rounding has made are dropped.
  [[nodiscard]] ParameterValue at(double share) const {
    const double exact = log ? from * std::pow(to / from, share) : from + (to - from) * share;
    if (whole) return static_cast<std::int64_t>(std::llround(exact));
    return std::strtod(fmt::format("{:.12g}", exact).c_str(), nullptr);
  }
};

Range read_range(const ParameterInfo& info, const toml::node& node, bool counted, const TomlTable& parent) {
  TomlTable table(*node.as_table(), parent.file(), info.name);
  if (!info.default_value.is_number()) parent.fail(node, info.name, "has no range; it is not a number");
  constexpr double any = 1e300;
  Range range;
  range.whole = info.default_value.is_number_integer();
  if (!table.has("from") || !table.has("to")) parent.fail(node, info.name, "needs from and to as a range");
  table.number("from", range.from, -any, any);
  table.number("to", range.to, -any, any);
  if (range.from >= range.to) table.fail(*table.find("to"), "to", "must be above from");
  for (const char* end : {"from", "to"})
    if (range.whole && !table.find(end)->is_integer()) table.fail(*table.find(end), end, "must be a whole number");
  std::string scale = "linear";
  table.text("scale", scale);
  if (scale != "linear" && scale != "log") table.fail(*table.find("scale"), "scale", "must be linear or log");
  range.log = scale == "log";
  if (range.log && range.from <= 0) table.fail(*table.find("from"), "from", "must be above 0 on a log scale");
  if (counted) {
    if (!table.has("count")) parent.fail(node, info.name, "needs a count: how many values from the range");
    table.integer("count", range.count, 2, most_settings);
  } else if (table.has("count")) {
    table.fail(*table.find("count"), "count", "belongs to a grid; a random design has one count for the sweep");
  }
  table.refuse_others();
  checked(info, range.at(0), node, parent);
  checked(info, range.at(1), node, parent);
  return range;
}

Values listed(const ParameterInfo& info, const toml::array& array, const TomlTable& table) {
  if (array.empty()) table.fail(array, info.name, "must have at least one value");
  Values values;
  for (const toml::node& element : array) {
    values.push_back(scalar(info, element, table));
    if (std::find(values.begin(), values.end() - 1, values.back()) != values.end() - 1)
      table.fail(element, info.name, "has the value " + values.back().dump() + " twice");
  }
  return values;
}

Values grid_values(const ParameterInfo& info, const toml::node& node, const TomlTable& table) {
  if (const toml::array* array = node.as_array()) return listed(info, *array, table);
  if (!node.is_table()) return {scalar(info, node, table)};
  const Range range = read_range(info, node, true, table);
  Values values;
  for (std::int64_t i = 0; i < range.count; ++i)
    values.push_back(range.at(static_cast<double>(i) / static_cast<double>(range.count - 1)));
  values.erase(std::unique(values.begin(), values.end()), values.end());  // of whole numbers
  return values;
}

std::vector<Json> grid(const Design& design, const std::vector<ParameterInfo>& known, const TomlTable& table) {
  std::vector<Json> settings{Json::object()};
  for (const auto& [name, node] : design.values) {
    const Values values = grid_values(info_of(known, name, *node, table), *node, table);
    if (settings.size() * values.size() > most_settings)
      table.fail(*node, name, fmt::format("makes more than {} settings", most_settings));
    std::vector<Json> product;
    for (const Json& setting : settings)
      for (const ParameterValue& value : values) {
        product.push_back(setting);
        product.back()[name] = value;
      }
    settings = std::move(product);
  }
  return settings;
}

std::vector<Json> list(const Design& design, const std::vector<ParameterInfo>& known, const TomlTable& table) {
  if (design.list->empty()) table.fail(*design.list, "parameters", "must have at least one setting");
  std::vector<Json> settings, resolved;
  for (const toml::node& element : *design.list) {
    if (!element.is_table())
      table.fail(element, "parameters", "must be settings, as [{ name = value, ... }, ...], with design = \"list\"");
    Json setting = Json::object();
    for (const auto& [key, node] : *element.as_table()) {
      const std::string name(key.str());
      setting[name] = scalar(info_of(known, name, node, table), node, table);
    }
    resolved.push_back(Parameters(known, setting).json());
    if (std::find(resolved.begin(), resolved.end() - 1, resolved.back()) != resolved.end() - 1)
      table.fail(element, "parameters", "has this setting twice, defaults filled in");
    settings.push_back(std::move(setting));
  }
  return settings;
}

// Mixes 64 bits so that consecutive numbers have nothing in common (steele2014, the finaliser of splitmix64).
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

// In [0, 1), by seed, number and name alone.
double drawn_share(std::int64_t seed, std::uint64_t number, const std::string& name) {
  std::uint64_t state = mixed(static_cast<std::uint64_t>(seed) + 0x9e3779b97f4a7c15u);
  state = mixed(state ^ (number + 0x9e3779b97f4a7c15u));
  for (const char letter : name) state = mixed(state ^ (static_cast<unsigned char>(letter) + 0x9e3779b97f4a7c15u));
  return static_cast<double>(state >> 11) * 0x1p-53;
}

// The source of a drawn parameter: values, or a range.
struct Drawn {
  std::string name;
  Values values;
  Range range;

  [[nodiscard]] ParameterValue at(double share) const {
    if (!values.empty()) return values[static_cast<std::size_t>(share * static_cast<double>(values.size()))];
    if (!range.whole || range.log) return range.at(share);
    // Every whole number has the same chance, the first and the last one, too.
    return static_cast<std::int64_t>(std::floor(range.from + share * (range.to - range.from + 1)));
  }
};

std::vector<Json> random(const Design& design, const std::vector<ParameterInfo>& known, const TomlTable& table) {
  std::vector<Drawn> parameters;
  for (const auto& [name, node] : design.values) {
    const ParameterInfo& info = info_of(known, name, *node, table);
    Drawn drawn{name, {}, {}};
    if (node->is_table())
      drawn.range = read_range(info, *node, false, table);
    else
      drawn.values = grid_values(info, *node, table);
    parameters.push_back(std::move(drawn));
  }
  std::vector<Json> settings;
  std::set<Json> known_settings;
  const std::uint64_t most_draws = 1000 * static_cast<std::uint64_t>(design.count);
  for (std::uint64_t i = 0; i < most_draws && settings.size() < static_cast<std::size_t>(design.count); ++i) {
    Json setting = Json::object();
    for (const Drawn& drawn : parameters) setting[drawn.name] = drawn.at(drawn_share(design.seed, i, drawn.name));
    if (known_settings.insert(setting).second) settings.push_back(std::move(setting));
  }
  if (settings.size() < static_cast<std::size_t>(design.count))
    table.fail(*design.count_at, "count",
               fmt::format("asks for {} settings, of which only {} differ", design.count, settings.size()));
  return settings;
}

}  // namespace

std::vector<Json> settings_of(const Design& design, const std::vector<ParameterInfo>& known, const TomlTable& table) {
  switch (design.kind) {
    case Design::Kind::grid:
      return grid(design, known, table);
    case Design::Kind::list:
      return list(design, known, table);
    case Design::Kind::random:
      return random(design, known, table);
  }
  return {};
}

}  // namespace lodestone
