// The rows of a sweep, joined with parameters and data and taken together over repetitions.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiments/report/study.h"

namespace lodestone {

// One value of a setting: median of a cost, with the least and largest of its repetitions (and within them, where there
// are columns NAME_min and NAME_max); anything else is the value of the first repetition that has it.
struct SettingCell {
  nlohmann::json value;  // number, text, truth value; null: not measured
  double least = 0, most = 0;
  int count = 0;  // repetitions that have it

  [[nodiscard]] bool is_number() const { return value.is_number(); }
  [[nodiscard]] double number() const { return value.get<double>(); }
};

// A row of a run, over its repetitions: cells of "sweep", "data", all parameters and all columns by name.
struct SettingRow {
  std::size_t run = 0;  // in the sweep
  std::size_t row = 0;  // in the run
  std::map<std::string, SettingCell> cells;

  // A null cell where there is none of that name.
  [[nodiscard]] const SettingCell& at(const std::string& name) const;
};

struct SettingTable {
  std::string sweep;
  std::vector<ColumnInfo> parameters;  // with "data", as labels, in the sweep's order
  std::vector<ColumnInfo> columns;     // without ranges NAME_min and NAME_max; with speedup ... where `threads` varies
  std::vector<SettingRow> settings;    // of runs that may be reported, in the sweep's order
  std::vector<std::string> varied;     // parameters and "data" with more than one value, texts that part rows of a run

  [[nodiscard]] const ColumnInfo* find(const std::string& name) const;  // parameter or column
};

// Rows of unverified, failed and missing runs are left out. O(rows log rows).
[[nodiscard]] SettingTable aggregate(const SweepRecord& sweep);

// Whether a column has several numbers or texts in one run: rows are told apart by it. Hashes tell nobody anything.
[[nodiscard]] bool parts_rows(const SettingTable& table, const std::string& column);

// "kappa0 = 2, blend = step": what a setting has of `names`.
[[nodiscard]] std::string setting_label(const SettingRow& setting, const std::vector<std::string>& names);

}  // namespace lodestone
