// The columns that figures and lists of metrics may name, and the settings of a sweep that have them.
#pragma once

#include <cstddef>
#include <set>
#include <string>

#include "experiments/sweep/sweep_file.h"

namespace lodestone {

// Columns of the experiment, and what the report derives from them.
[[nodiscard]] std::set<std::string> column_names(const Experiment& experiment);
// These, parameters, and what a reader joins to the rows: what a figure may name.
[[nodiscard]] std::set<std::string> figure_names(const Experiment& experiment);

struct ColumnPresence {
  std::size_t settings = 0;  // of the sweep that have the column
  std::string remedy;        // for the others, as "set image = true"; empty: there are none
};
// Names that are not columns are in all settings. O(settings).
[[nodiscard]] ColumnPresence presence(const SweepSection& sweep, const std::string& name);

// "set image = true": what a setting needs for the column; empty: nothing.
[[nodiscard]] std::string needs_text(const ColumnInfo& column);

}  // namespace lodestone
