#include "experiments/report/aggregate.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "experiments/metrics/cost/order_statistics.h"
#include "experiments/metrics/cost/scaling.h"
#include "experiments/report/number_text.h"

namespace lodestone {
namespace {

using Kind = ColumnInfo::Kind;
using nlohmann::json;

SettingCell plain_cell(const json& value) {
  SettingCell cell{value, 0, 0, 1};
  if (value.is_number()) cell.least = cell.most = value.get<double>();
  return cell;
}

// Values of a column in several repetitions; null where it has none.
std::vector<json> values_of(const std::vector<const Row*>& rows, const std::string& column) {
  std::vector<json> values;
  for (const Row* row : rows) values.push_back(row->value(column, json()));
  return values;
}

std::vector<double> numbers_in(const std::vector<json>& values) {
  std::vector<double> numbers;
  for (const json& value : values)
    if (value.is_number()) numbers.push_back(value.get<double>());
  return numbers;
}

SettingCell cost_cell(const std::vector<const Row*>& rows, const std::string& column) {
  const std::vector<double> numbers = numbers_in(values_of(rows, column));
  if (numbers.empty()) return {};
  std::vector<double> all = numbers;
  for (const char* end : {"_min", "_max"})
    for (const double number : numbers_in(values_of(rows, column + end))) all.push_back(number);
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  return {median_of(numbers), *least, *most, static_cast<int>(numbers.size())};
}

// The first value that there is; others equal it (unsteady_results).
SettingCell first_cell(const std::vector<json>& values) {
  SettingCell cell;
  for (const json& value : values) {
    if (value.is_null()) continue;
    if (cell.count == 0)
      cell = plain_cell(value);
    else
      ++cell.count;
  }
  return cell;
}

SettingCell join(const ColumnInfo& column, const std::vector<const Row*>& rows) {
  const std::vector<json> values = values_of(rows, column.name);
  const bool text =
      std::any_of(values.begin(), values.end(), [](const json& v) { return v.is_string() || v.is_boolean(); });
  return column.kind == Kind::cost && !text ? cost_cell(rows, column.name) : first_cell(values);
}

void add_run(SettingTable& table, const SweepRecord& sweep, std::size_t index) {
  const RunRecord& run = sweep.runs[index];
  std::vector<std::vector<const Row*>> rows;  // by place in the run, then repetition
  for (const Repetition& repetition : run.repetitions) {
    if (!repetition.has_rows || repetition.fault) continue;
    rows.resize(std::max(rows.size(), repetition.rows.size()));
    for (std::size_t i = 0; i < repetition.rows.size(); ++i) rows[i].push_back(&repetition.rows[i]);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SettingRow setting{index, i, {{"sweep", plain_cell(sweep.name)}, {"data", plain_cell(run.data)}}};
    for (const auto& [name, value] : run.parameters.items()) setting.cells[name] = plain_cell(value);
    for (const ColumnInfo& column : sweep.columns) setting.cells[column.name] = join(column, rows[i]);
    table.settings.push_back(std::move(setting));
  }
}

// Costs NAME_min and NAME_max are shown as the range of NAME.
std::vector<ColumnInfo> without_ranges(const std::vector<ColumnInfo>& columns) {
  std::set<std::string> names;
  for (const ColumnInfo& column : columns)
    if (column.kind == Kind::cost) names.insert(column.name);
  std::vector<ColumnInfo> kept;
  for (const ColumnInfo& column : columns) {
    const bool range = column.name.ends_with("_min") || column.name.ends_with("_max");
    if (!range || column.kind != Kind::cost || !names.contains(column.name.substr(0, column.name.size() - 4)))
      kept.push_back(column);
  }
  return kept;
}

// A hash parts rows, but tells nobody anything.
bool is_hash(const std::string& text) {
  return text.size() >= 8 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

// Whether a label says nothing that the names before it have not said.
bool is_told(const SettingTable& table, const std::string& label, const std::vector<std::string>& names) {
  std::map<std::string, json> told;
  for (const SettingRow& setting : table.settings) {
    const json& value = setting.at(label).value;
    if (told.emplace(setting_label(setting, names), value).first->second != value) return false;
  }
  return true;
}

std::vector<std::string> varied_names(const SettingTable& table) {
  std::vector<std::string> varied;
  for (const ColumnInfo& parameter : table.parameters) {
    std::set<std::string> values;
    for (const SettingRow& setting : table.settings) values.insert(setting.at(parameter.name).value.dump());
    if (values.size() > 1) varied.push_back(parameter.name);
  }
  for (const ColumnInfo& column : table.columns)
    if (column.kind == Kind::label && parts_rows(table, column.name) && !is_told(table, column.name, varied))
      varied.push_back(column.name);
  return varied;
}

// Everything that a setting is, but the number of threads.
std::string key_without_threads(const SettingTable& table, const SettingRow& setting) {
  std::string key = std::to_string(setting.row) + "\n";
  for (const std::string& name : table.varied)
    if (name != "threads") key += setting.at(name).value.dump() + "\n";
  return key;
}

Scaling scaling_of(double seconds_of_one, double seconds, int threads) {
  if (threads == 1) return {};
  const ThreadTime times[] = {{1, seconds_of_one}, {threads, seconds}};
  return scaling(times)[1];
}

// Ranges are those of the least favourable pairs of repetitions.
void set_scaling(SettingRow& setting, const SettingCell& one, const SettingCell& time, int threads) {
  const Scaling middle = scaling_of(one.number(), time.number(), threads);
  const Scaling slow = scaling_of(one.least, time.most, threads), fast = scaling_of(one.most, time.least, threads);
  setting.cells["speedup"] = {middle.speedup, slow.speedup, fast.speedup, time.count};
  setting.cells["efficiency"] = {middle.efficiency, slow.efficiency, fast.efficiency, time.count};
  if (threads > 1) setting.cells["karp_flatt"] = {middle.karp_flatt, fast.karp_flatt, slow.karp_flatt, time.count};
}

void add_scaling(SettingTable& table) {
  const std::string name = "seconds";
  const bool varies = std::find(table.varied.begin(), table.varied.end(), "threads") != table.varied.end();
  if (!varies || table.find(name) == nullptr || table.find("speedup") != nullptr) return;
  std::map<std::string, SettingCell> ones;
  for (const SettingRow& setting : table.settings)
    if (const SettingCell& seconds = setting.at(name);
        setting.at("threads").value == 1 && seconds.is_number() && seconds.least > 0)
      ones.emplace(key_without_threads(table, setting), seconds);
  for (SettingRow& setting : table.settings) {
    const auto one = ones.find(key_without_threads(table, setting));
    const SettingCell seconds = setting.at(name), threads = setting.at("threads");
    if (one != ones.end() && seconds.is_number() && seconds.least > 0 && threads.is_number() && threads.number() >= 1)
      set_scaling(setting, one->second, seconds, static_cast<int>(threads.number()));
  }
  table.columns.push_back({"speedup", "", "seconds of one thread over seconds", Kind::cost});
  table.columns.push_back({"efficiency", "", "speed-up over threads", Kind::cost});
  table.columns.push_back({"karp_flatt", "", "serial share that would explain the speed-up", Kind::cost});
}

}  // namespace

const SettingCell& SettingRow::at(const std::string& name) const {
  static const SettingCell nothing;
  const auto found = cells.find(name);
  return found == cells.end() ? nothing : found->second;
}

const ColumnInfo* SettingTable::find(const std::string& name) const {
  for (const auto* list : {&parameters, &columns})
    for (const ColumnInfo& column : *list)
      if (column.name == name) return &column;
  return nullptr;
}

bool parts_rows(const SettingTable& table, const std::string& column) {
  std::map<std::size_t, std::set<std::string>> of_run;
  for (const SettingRow& setting : table.settings)
    if (const json& value = setting.at(column).value; value.is_string() || value.is_number()) {
      if (value.is_string() && is_hash(value.get<std::string>())) return false;
      of_run[setting.run].insert(value.dump());
    }
  return std::any_of(of_run.begin(), of_run.end(), [](const auto& entry) { return entry.second.size() > 1; });
}

SettingTable aggregate(const SweepRecord& sweep) {
  SettingTable table;
  table.sweep = sweep.name;
  if (std::any_of(sweep.runs.begin(), sweep.runs.end(), [](const RunRecord& run) { return !run.data.empty(); }))
    table.parameters.push_back({"data", "", "what it ran on", Kind::label});
  for (const ParameterInfo& p : sweep.parameters)
    table.parameters.push_back({p.name, p.unit, p.description, Kind::label});
  table.columns = without_ranges(sweep.columns);
  for (std::size_t i = 0; i < sweep.runs.size(); ++i)
    if (is_reported(state_of(sweep.runs[i]))) add_run(table, sweep, i);
  table.varied = varied_names(table);
  add_scaling(table);
  return table;
}

std::string setting_label(const SettingRow& setting, const std::vector<std::string>& names) {
  std::string label;
  for (const std::string& name : names)
    if (const SettingCell& cell = setting.at(name); !cell.value.is_null())
      label += fmt::format("{}{} = {}", label.empty() ? "" : ", ", name, value_text(cell.value));
  return label;
}

}  // namespace lodestone
