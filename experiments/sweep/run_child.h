// The child's side of a run: one repetition of one experiment, from the job in a work folder to the rows in it.
#pragma once

#include <filesystem>

#include "experiments/studies/experiment.h"

namespace lodestone {

// Faults of rows of any experiment: a column that it does not declare, a value that is not a scalar or not
// finite.
[[nodiscard]] std::vector<std::string> faulty_values(const Experiment& experiment, const std::vector<Row>& rows);

// A run, and what is wrong with its rows: faulty values, or else what the experiment itself finds; empty: nothing.
struct CheckedRows {
  std::vector<Row> rows;
  std::vector<std::string> faults;
};
[[nodiscard]] CheckedRows run_checked(const Experiment& experiment, const Parameters& parameters,
                                      const RunContext& context);

// Leaves rows, manifest and, where something went wrong, a fault in the folder. `report` is a descriptor that takes the
// share done, a line each. Throws Cancelled; FileError when the results cannot be written.
void run_child(const std::filesystem::path& folder, int report, const CancelFlag& cancel);

}  // namespace lodestone
