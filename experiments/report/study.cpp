#include "experiments/report/study.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "core/base/error.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  // An empty file sets the fail bit of what it is written to, and is no error of reading.
  if (file && file.peek() != std::ifstream::traits_type::eof()) text << file.rdbuf();
  if (!file.is_open() || file.bad() || !text) throw FileError(describe(path.string(), "", "cannot be read"));
  return std::move(text).str();
}

json parse(const std::string& text, const fs::path& path, const std::string& place) {
  try {
    return json::parse(text);
  } catch (const json::parse_error& e) {
    throw InputError(describe(path.string(), place, fmt::format("is no JSON, from byte {} on", e.byte)));
  }
}

// An object of a file, whose members are asked for by name and kind.
class Object {
 public:
  Object(const json& value, const fs::path& path, std::string place)
      : value_(value), path_(path), place_(std::move(place)) {
    if (!value.is_object()) fail("is no object");
  }

  [[nodiscard]] std::string text(const char* key) const {
    const json& v = member(key);
    if (!v.is_string()) fail(fmt::format("'{}' is no text", key));
    return v.get<std::string>();
  }
  [[nodiscard]] std::string text_or_nothing(const char* key) const {
    return value_.contains(key) && !value_.at(key).is_null() ? text(key) : std::string();
  }
  [[nodiscard]] int count(const char* key) const {
    const json& v = member(key);
    if (!v.is_number_unsigned() || v.get<std::uint64_t>() > 1000000) fail(fmt::format("'{}' is no count", key));
    return v.get<int>();
  }
  [[nodiscard]] bool flag(const char* key) const { return value_.contains(key) && value_.at(key) == true; }
  // One text stands for a list of one.
  [[nodiscard]] std::vector<std::string> texts(const char* key) const {
    std::vector<std::string> list;
    if (!value_.contains(key)) return list;
    const json& v = value_.at(key);
    for (const json& entry : v.is_array() ? v : json::array({v})) {
      if (!entry.is_string()) fail(fmt::format("'{}' holds something else than texts", key));
      list.push_back(entry.get<std::string>());
    }
    return list;
  }
  [[nodiscard]] std::vector<Object> objects(const char* key) const {
    std::vector<Object> list;
    const json& v = member(key);
    if (!v.is_array()) fail(fmt::format("'{}' is no list", key));
    for (std::size_t i = 0; i < v.size(); ++i) list.emplace_back(v[i], path_, fmt::format("{}[{}]", key, i));
    return list;
  }
  [[nodiscard]] const json& member(const char* key) const {
    if (!value_.contains(key)) fail(fmt::format("has no '{}'", key));
    return value_.at(key);
  }
  [[noreturn]] void fail(const std::string& what) const { throw InputError(describe(path_.string(), place_, what)); }

 private:
  const json& value_;
  const fs::path& path_;
  std::string place_;
};

FigureRequest read_figure(const Object& o) {
  FigureRequest f;
  f.title = o.text("title");
  f.sweeps = o.texts("sweep");
  f.x = o.text("x");
  f.y = o.texts("y");
  f.series = o.texts("series");
  if (const std::string kind = o.text_or_nothing("kind"); !kind.empty()) f.kind = kind;
  if (f.kind != "line" && f.kind != "scatter" && f.kind != "bar") o.fail("'kind' is not line, scatter or bar");
  if (f.sweeps.empty() || f.y.empty()) o.fail("names no sweep or no y");
  const std::string log = o.text_or_nothing("log");
  f.log_x = log.find('x') != std::string::npos;
  f.log_y = log.find('y') != std::string::npos;
  f.mark = o.text_or_nothing("mark");
  f.pareto = o.flag("pareto");
  return f;
}

ColumnInfo read_column(const Object& o) {
  using Kind = ColumnInfo::Kind;
  static const std::vector<std::pair<std::string, Kind>> kinds = {{"label", Kind::label},
                                                                  {"accuracy", Kind::accuracy},
                                                                  {"quality", Kind::quality},
                                                                  {"cost", Kind::cost},
                                                                  {"count", Kind::count}};
  const std::string kind = o.text("kind");
  const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const auto& entry) { return entry.first == kind; });
  if (found == kinds.end()) o.fail("'kind' is not label, accuracy, quality, cost or count");
  return {o.text("name"), o.text_or_nothing("unit"), o.text_or_nothing("meaning"), found->second};
}

// Rows as JSON lines, each a flat object with columns of the experiment. Rows that did not verify need not be: what is
// wrong with them has been said.
std::vector<Row> read_rows(const fs::path& path, const std::set<std::string>& columns, bool verified) {
  std::vector<Row> rows;
  std::istringstream text(read_text(path));
  std::size_t number = 0;
  for (std::string line; std::getline(text, line);) {
    const std::string place = fmt::format("line {}", ++number);
    Row row = parse(line, path, place);
    if (!verified && !row.is_object()) continue;
    const Object object(row, path, place);
    for (const auto& [name, value] : row.items()) {
      if (!verified) continue;
      if (!columns.contains(name)) object.fail(fmt::format("'{}' is no column of the experiment", name));
      if (value.is_structured()) object.fail(fmt::format("'{}' is neither number, text nor truth value", name));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

RunFault read_fault(const fs::path& path) {
  const json value = parse(read_text(path), path, "");
  const Object object(value, path, "");
  return {object.text("kind"), object.texts("messages")};
}

Repetition read_repetition(const fs::path& folder, int number, const std::set<std::string>& columns) {
  Repetition repetition;
  repetition.number = number;
  if (const fs::path path = folder / fmt::format("fault.{}.json", number); fs::exists(path))
    repetition.fault = read_fault(path);
  if (const fs::path path = folder / fmt::format("rows.{}.jsonl", number); fs::exists(path)) {
    repetition.rows = read_rows(path, columns, !repetition.fault);
    repetition.has_rows = true;
  }
  if (const fs::path path = folder / fmt::format("manifest.{}.json", number); fs::exists(path)) {
    repetition.manifest = parse(read_text(path), path, "");
    (void)Object(repetition.manifest, path, "");
  }
  return repetition;
}

bool agree(const json& one, const json& other) {
  if (!one.is_number() || !other.is_number()) return one == other;
  return std::abs(one.get<double>() - other.get<double>()) <= 1e-9 * std::abs(one.get<double>());
}

std::string exact_text(const json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

// Of the rows at each place, each against the first that has the column. Empty: none.
std::string difference_in(const ColumnInfo& column, const std::vector<const Repetition*>& repetitions) {
  if (column.kind == ColumnInfo::Kind::cost || repetitions.empty()) return {};
  for (std::size_t i = 0; i < repetitions.front()->rows.size(); ++i) {
    json first;
    for (const Repetition* repetition : repetitions) {
      const json value = repetition->rows[i].value(column.name, json());
      if (first.is_null()) first = value;
      if (value.is_null() || agree(first, value)) continue;
      return fmt::format("{} differs between repetitions: {} and {}", column.name, exact_text(first),
                         exact_text(value));
    }
  }
  return {};
}

RunRecord read_run(const Object& o, const fs::path& runs, int repetitions, const std::vector<ColumnInfo>& columns) {
  std::set<std::string> names;
  for (const ColumnInfo& column : columns) names.insert(column.name);
  RunRecord run;
  run.id = o.text("id");
  run.data = o.text_or_nothing("data");
  run.parameters = o.member("parameters");
  if (!run.parameters.is_object()) o.fail("'parameters' is no object");
  if (run.id.empty() || run.id.find('/') != std::string::npos || run.id.starts_with('.'))
    o.fail("'id' is no name of a folder");
  const fs::path folder = runs / run.id;
  if (const fs::path path = folder / "parameters.json"; fs::exists(path)) {
    const json value = parse(read_text(path), path, "");
    const Object stored(value, path, "");
    run.program = stored.text_or_nothing("program");
    run.input = stored.text_or_nothing("input");
    run.input_sha256 = stored.text_or_nothing("input_sha256");
  }
  for (int r = 0; r < repetitions; ++r) run.repetitions.push_back(read_repetition(folder, r, names));
  run.unsteady = unsteady_results(run, columns);
  if (fs::is_directory(folder))
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".png") run.pictures.push_back(entry.path());
  // A picture before its difference map: "worst", "worst.difference".
  std::sort(run.pictures.begin(), run.pictures.end(),
            [](const fs::path& a, const fs::path& b) { return a.stem() < b.stem(); });
  return run;
}

SweepRecord read_sweep(const Object& o, const fs::path& runs) {
  SweepRecord sweep;
  sweep.name = o.text("name");
  sweep.experiment = o.text("experiment");
  sweep.question = o.text_or_nothing("question");
  sweep.repetitions = o.count("repetitions");
  for (const Object& p : o.objects("parameters"))
    sweep.parameters.push_back(
        {p.text("name"), nullptr, p.text_or_nothing("unit"), p.text_or_nothing("description"), 0, 0, {}});
  for (const Object& c : o.objects("columns")) sweep.columns.push_back(read_column(c));
  sweep.metrics = o.texts("metrics");
  for (const Object& r : o.objects("runs")) sweep.runs.push_back(read_run(r, runs, sweep.repetitions, sweep.columns));
  return sweep;
}

std::size_t count_other_runs(const Study& study) {
  std::set<std::string> listed;
  for (const SweepRecord& sweep : study.sweeps)
    for (const RunRecord& run : sweep.runs) listed.insert(run.id);
  std::size_t others = 0;
  if (fs::is_directory(study.folder / "runs"))
    for (const fs::directory_entry& entry : fs::directory_iterator(study.folder / "runs"))
      others += entry.is_directory() && !listed.contains(entry.path().filename().string()) ? 1 : 0;
  return others;
}

}  // namespace

std::vector<std::string> unsteady_results(const RunRecord& run, const std::vector<ColumnInfo>& columns) {
  std::vector<const Repetition*> repetitions;
  for (const Repetition& r : run.repetitions)
    if (r.has_rows && !r.fault) repetitions.push_back(&r);
  std::vector<std::string> unsteady;
  for (std::size_t i = 1; i < repetitions.size(); ++i)
    if (const std::size_t one = repetitions.front()->rows.size(), other = repetitions[i]->rows.size(); one != other)
      return {fmt::format("the number of rows differs between repetitions: {} and {}", one, other)};
  for (const ColumnInfo& column : columns)
    if (const std::string difference = difference_in(column, repetitions); !difference.empty())
      unsteady.push_back(difference);
  return unsteady;
}

RunState state_of(const RunRecord& run) {
  if (!run.unsteady.empty()) return RunState::unverified;
  std::size_t good = 0, faults = 0;
  for (const Repetition& r : run.repetitions) {
    if (r.fault && r.fault->kind == "verify") return RunState::unverified;
    good += r.has_rows && !r.fault ? 1 : 0;
    faults += r.fault ? 1 : 0;
  }
  if (good == run.repetitions.size() && good > 0) return RunState::complete;
  if (good > 0) return RunState::incomplete;
  return faults > 0 ? RunState::failed : RunState::missing;
}

Study read_study(const fs::path& folder) {
  if (!fs::is_directory(folder))
    throw FileError(
        describe(folder.string(), "", fs::exists(folder) ? "is no folder" : "cannot be opened: no such folder"));
  const fs::path path = folder / "sweep.json";
  if (!fs::exists(path))
    throw InputError(describe(folder.string(), "", "is not the directory of a sweep: it has no sweep.json",
                              "`lodestone sweep FILE.toml -o DIR` makes one"));
  const json value = parse(read_text(path), path, "");
  const Object object(value, path, "");
  Study study;
  study.folder = folder;
  study.name = object.text("name");
  study.title = object.text_or_nothing("title");
  if (study.title.empty()) study.title = study.name;
  study.question = object.text_or_nothing("question");
  study.program = object.text_or_nothing("program");
  for (const Object& s : object.objects("sweeps")) study.sweeps.push_back(read_sweep(s, folder / "runs"));
  for (const Object& f : object.objects("figures")) study.figures.push_back(read_figure(f));
  for (const FigureRequest& figure : study.figures)
    for (const std::string& name : figure.sweeps)
      if (std::none_of(study.sweeps.begin(), study.sweeps.end(), [&](const auto& s) { return s.name == name; }))
        object.fail(fmt::format("figure '{}' is of a sweep '{}' that is not there", figure.title, name));
  study.other_runs = count_other_runs(study);
  return study;
}

}  // namespace lodestone
