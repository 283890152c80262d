#include "experiments/sweep/sweep_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <set>

#include "core/base/known_names.h"
#include "experiments/sweep/column_presence.h"
#include "experiments/sweep/contradictions.h"
#include "experiments/sweep/design.h"
#include "experiments/sweep/figure_section.h"
#include "experiments/sweep/name_lists.h"
#include "render/scene/toml_table.h"

namespace lodestone {
namespace {

// Names become parts of file names, and columns of a table.
bool is_plain(const std::string& name) {
  return !name.empty() &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '.'; }) &&
         name.front() != '.' && name.front() != '-';
}

void read_name(TomlTable& table, const toml::source_region& at, std::string& name) {
  table.text("name", name);
  if (!table.has("name")) table.fail_at(at, "needs a name");
  if (!is_plain(name)) table.fail(*table.find("name"), "name", "must be made of letters, digits, '_', '-' and '.'");
}

DataSource read_source(const std::string& name, const toml::node& node, const TomlTable& data) {
  if (!is_plain(name)) data.fail(node, name, "must be made of letters, digits, '_', '-' and '.'");
  if (!node.is_table()) data.fail(node, name, "must be { path = \"...\" } or { generate = \"...\" }");
  TomlTable table(*node.as_table(), data.file(), name);
  DataSource source;
  source.name = name;
  source.place = "line " + std::to_string(node.source().begin.line);
  table.text("path", source.path);
  table.text("generate", source.shape);
  table.text("sha256", source.sha256);
  std::int64_t triangles = 100'000, seed = 1;
  table.integer("triangles", triangles, 12, 2'000'000'000);
  table.integer("seed", seed, 0, std::numeric_limits<std::int64_t>::max());
  for (const std::string& path : texts(table, "with")) source.with.push_back(beside(data.file(), path));
  table.refuse_others();
  if (source.path.empty() == source.shape.empty())
    table.fail(node, "path", "or generate is needed, one of them, to say what the data is");
  const bool generated = source.path.empty();
  for (const char* key : {"triangles", "seed"})
    if (!generated && table.has(key)) table.fail(*table.find(key), key, "belongs to generate");
  for (const char* key : {"sha256", "with"})
    if (generated && table.has(key)) table.fail(*table.find(key), key, "belongs to path");
  const auto is_digit = [](char c) { return std::string_view("0123456789abcdef").find(c) != std::string_view::npos; };
  if (table.has("sha256") &&
      (source.sha256.size() != 64 || !std::all_of(source.sha256.begin(), source.sha256.end(), is_digit)))
    table.fail(*table.find("sha256"), "sha256", "must be 64 hexadecimal digits, as sha256sum prints them");
  if (!generated) {
    source.path = beside(data.file(), source.path);
    return source;
  }
  try {
    source.generate = {shape_named(source.shape), static_cast<std::uint64_t>(triangles),
                       static_cast<std::uint64_t>(seed)};
  } catch (const InputError& error) {
    table.fail(*table.find("generate"), "generate", std::string("is wrong: ") + error.what());
  }
  return source;
}

std::vector<DataSource> read_data(TomlTable& root) {
  std::vector<DataSource> sources;
  const toml::node* node = root.find("data");
  if (!node) return sources;
  if (!node->is_table()) root.fail(*node, "data", "must be a table, as [data]");
  const TomlTable data(*node->as_table(), root.file(), "data");
  for (const auto& [key, value] : *node->as_table())
    sources.push_back(read_source(std::string(key.str()), value, data));
  return sources;
}

// Reads a [[sweep]], its `small` or its `full`.
struct SweepReader {
  const SweepFile& file;
  const Experiment& experiment;

  std::vector<std::string> data(TomlTable& table, const toml::node& at) const {
    const std::vector<std::string> names = texts(table, "data");
    if (!experiment.takes_input) {
      if (table.has("data"))
        table.fail(*table.find("data"), "data", "is given, but " + experiment.name + " takes none");
      return {};
    }
    if (names.empty()) table.fail_at(at.source(), "needs data: " + experiment.name + " takes input");
    std::vector<std::string> known;
    for (const DataSource& source : file.data) known.push_back(source.name);
    for (const std::string& name : names)
      if (std::find(known.begin(), known.end(), name) == known.end())
        table.fail(*table.find("data"), "data", fmt::format("'{}' is unknown; {}", name, known_names(name, known)));
    return names;
  }

  int repetitions(TomlTable& table) const {
    std::int64_t count = 1;
    table.integer("repetitions", count, 1, 10'000);
    return static_cast<int>(count);
  }

  // Takes over `parameters` and `count`; of a grid or random design, parameter by parameter.
  void design(TomlTable& table, Design& design) const {
    const toml::node* node = table.find("parameters");
    if (node && design.kind == Design::Kind::list) {
      if (!node->is_array())
        table.fail(*node, "parameters", "must be settings, as [{ name = value, ... }, ...], with design = \"list\"");
      design.list = node->as_array();
    } else if (node) {
      if (!node->is_table())
        table.fail(*node, "parameters", "must be a table, as { name = value, ... }; a list needs design = \"list\"");
      for (const auto& [key, value] : *node->as_table()) design.values[std::string(key.str())] = &value;
    }
    if (!table.has("count")) return;
    if (design.kind != Design::Kind::random)
      table.fail(*table.find("count"), "count", "belongs to design = \"random\"");
    table.integer("count", design.count, 1, most_settings);
    design.count_at = table.find("count");
  }

  std::vector<Json> settings(const Design& design, const TomlTable& table) const {
    std::vector<Json> made = settings_of(design, experiment.parameters, table);
    refuse_contradictions(design, made, experiment, table);
    return made;
  }
};

Design::Kind design_kind(TomlTable& table) {
  std::string name = "grid";
  table.text("design", name);
  if (name == "grid") return Design::Kind::grid;
  if (name == "list") return Design::Kind::list;
  if (name == "random") return Design::Kind::random;
  table.fail(*table.find("design"), "design", "must be one of grid, list, random");
}

void read_design(TomlTable& table, const toml::node& at, const SweepReader& reader, Design& design) {
  design.kind = design_kind(table);
  reader.design(table, design);
  if (design.kind == Design::Kind::list && !design.list)
    table.fail_at(at.source(), "needs parameters, the settings of its list");
  if (design.kind == Design::Kind::random && !design.count_at)
    table.fail_at(at.source(), "needs a count: how many settings to draw");
  if (design.kind != Design::Kind::random && table.has("seed"))
    table.fail(*table.find("seed"), "seed", "belongs to design = \"random\"");
  table.integer("seed", design.seed, 0, std::numeric_limits<std::int64_t>::max());
}

std::vector<std::string> read_metrics(TomlTable& table, const SweepSection& sweep, SweepFile& file) {
  const std::vector<std::string> metrics = texts(table, "metrics");
  const std::set<std::string> known = column_names(*sweep.experiment);
  for (const std::string& name : metrics) {
    if (!known.contains(name))
      table.fail(*table.find("metrics"), "metrics",
                 fmt::format("'{}' is not a column of {}; {}", name, sweep.experiment->name,
                             known_names(name, {known.begin(), known.end()})));
    check_presence(table, "metrics", name, sweep, "sweep '" + sweep.name + "'", file);
  }
  return metrics;
}

SweepSection read_sweep(TomlTable& table, const toml::node& at, SweepFile& file, const ExperimentLookup& lookup) {
  SweepSection section;
  read_name(table, at.source(), section.name);
  for (const SweepSection& other : file.sweeps)
    if (other.name == section.name)
      table.fail(*table.find("name"), "name", "'" + section.name + "' is another sweep's already");
  std::string experiment;
  table.text("experiment", experiment);
  if (experiment.empty()) table.fail_at(at.source(), "needs an experiment; see lodestone experiments");
  try {
    section.experiment = &lookup(experiment);
  } catch (const InputError& error) {
    table.fail(*table.find("experiment"), "experiment", std::string("is wrong: ") + error.what());
  }
  const SweepReader reader{file, *section.experiment};
  section.data = reader.data(table, at);
  section.repetitions = reader.repetitions(table);
  Design design;
  read_design(table, at, reader, design);
  section.settings = reader.settings(design, table);

  const SweepSection standard = section;
  for (const SweepForm form : {SweepForm::small, SweepForm::full}) {
    const std::string key(name_of(form));
    table.sub_table(key.c_str(), [&](TomlTable& overrides) {
      SweepSection changed = standard;
      if (overrides.has("data")) changed.data = reader.data(overrides, *table.find(key.c_str()));
      if (overrides.has("repetitions")) changed.repetitions = reader.repetitions(overrides);
      Design changed_design = design;
      reader.design(overrides, changed_design);
      changed.settings = reader.settings(changed_design, overrides);
      for (const char* known : {"data", "repetitions", "parameters", "count"}) (void)overrides.find(known);
      if (file.form == form) section = std::move(changed);
    });
  }
  section.metrics = read_metrics(table, section, file);
  return section;
}

}  // namespace

std::string_view name_of(SweepForm form) {
  constexpr std::array<std::string_view, 3> names{"small", "standard", "full"};
  return names[static_cast<std::size_t>(form)];
}

SweepFile load_sweep_file(const std::string& path, SweepForm form, const ExperimentLookup& lookup) {
  const toml::table root = parse_toml(path);
  TomlTable table(root, path, "");
  SweepFile file;
  file.file = path;
  file.form = form;
  read_name(table, root.source(), file.name);
  file.title = file.name;
  table.text("title", file.title);
  table.text("question", file.question);
  file.data = read_data(table);
  table.tables("sweep", [&](TomlTable& sweep, const toml::node& at) {
    file.sweeps.push_back(read_sweep(sweep, at, file, lookup));
  });
  if (file.sweeps.empty()) throw InputError(describe(path, {}, "has no sweeps", "add a [[sweep]] with an experiment"));
  file.files = read_parameter_files(file);
  table.tables("figure",
               [&](TomlTable& figure, const toml::node& at) { file.figures.push_back(read_figure(figure, at, file)); });
  table.refuse_others();
  return file;
}

void keep_sweeps(SweepFile& file, const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const SweepSection& section : file.sweeps) known.push_back(section.name);
  for (const std::string& name : names)
    if (std::ranges::find(known, name) == known.end())
      throw InputError(file.file + ": no sweep '" + name + "'; " + known_names(name, known));
  const auto kept = [&](const std::string& name) { return std::ranges::find(names, name) != names.end(); };
  std::erase_if(file.sweeps, [&](const SweepSection& section) { return !kept(section.name); });
  std::erase_if(file.figures, [&](const FigureSpec& figure) { return !std::ranges::all_of(figure.sweep, kept); });
}

}  // namespace lodestone
