// What lies in a sweep's directory (docs/decisions/0036-sweeps.md), read and checked.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "experiments/studies/experiment.h"

namespace lodestone {

// A figure as the sweep's file asks for it.
struct FigureRequest {
  std::string title;
  std::vector<std::string> sweeps;
  std::string x;
  std::vector<std::string> y;
  std::vector<std::string> series;  // one curve per combination of their values
  std::string kind = "line";        // "line", "scatter", "bar"
  bool log_x = false, log_y = false;
  std::string mark;  // column drawn as a vertical line; empty: none
  bool pareto = false;
};

struct RunFault {
  std::string kind;  // "verify", "error", "crash"
  std::vector<std::string> messages;
};

// One repetition of a run: rows, or a fault, or both (rows that do not verify), or nothing yet.
struct Repetition {
  int number = 0;
  bool has_rows = false;
  std::vector<Row> rows;
  std::optional<RunFault> fault;
  nlohmann::json manifest = nlohmann::json::object();
};

struct RunRecord {
  std::string id, data;
  nlohmann::json parameters = nlohmann::json::object();
  std::string program, input, input_sha256;  // of parameters.json; empty where it has none
  std::vector<Repetition> repetitions;       // as many as the sweep asks for, in order
  std::vector<std::string> unsteady;         // what differs between repetitions and must not, in words
  std::vector<std::filesystem::path> pictures;
};

// Equal settings on equal input give equal results: all but costs, as far as both of two repetitions have them. Of
// numbers the last digits may differ, as of a sum in another order. The columns that do not, with two of their values,
// once each; of repetitions without fault.
[[nodiscard]] std::vector<std::string> unsteady_results(const RunRecord& run, const std::vector<ColumnInfo>& columns);

// What became of a run.
enum class RunState {
  complete,
  incomplete,  // some repetitions have rows that may be reported
  unverified,  // the rows of at least one repetition are wrong, or not those of another: none may be reported
  failed,      // every repetition that began ended in an error or a crash
  missing      // not yet run
};
[[nodiscard]] RunState state_of(const RunRecord& run);
[[nodiscard]] constexpr bool is_reported(RunState state) {
  return state == RunState::complete || state == RunState::incomplete;
}

struct SweepRecord {
  std::string name, experiment, question;
  int repetitions = 1;
  std::vector<ParameterInfo> parameters;  // name, unit and description
  std::vector<ColumnInfo> columns;
  std::vector<std::string> metrics;  // columns that the table shows beside parameters; empty: all
  std::vector<RunRecord> runs;
};

struct Study {
  std::filesystem::path folder;
  std::string name, title, question, program;
  std::vector<FigureRequest> figures;
  std::vector<SweepRecord> sweeps;
  std::size_t other_runs = 0;  // in the folder, but of no sweep: of other settings or another program
};

// Throws FileError when there is no such folder or a file cannot be read, InputError that names file, line and what is
// wrong for a folder that is not a sweep's and for content that breaks the contract.
[[nodiscard]] Study read_study(const std::filesystem::path& folder);

}  // namespace lodestone
