// The plan of a sweep: its runs, by the hash of everything that decides their results.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/files/json.h"
#include "experiments/sweep/inputs.h"
#include "experiments/sweep/sweep_file.h"

namespace lodestone {

// One setting of an experiment on one input.
struct SweepRun {
  std::string id;  // 16 hexadecimal digits; empty while the input has yet to be made
  const Experiment* experiment = nullptr;
  std::string program;      // hash of executable and libraries
  std::string sweep, data;  // names, of the first sweep that has it
  Json given;               // what the file sets
  Json parameters;
  ParameterFiles files;  // that parameters name, by parameter
  SweepInput input;
  int repetitions = 1;  // the most that a sweep asks for
};

struct SweepPlan {
  std::vector<SweepRun> runs;  // each once, though several sweeps may have it; in the order of the file
  Json json;                   // for sweep.json, as the decision has it
  std::map<std::string, std::string> left_out;  // data without an input, and the file that is missing
};

// name, unit, meaning and kind.
[[nodiscard]] Json to_json(const ColumnInfo& column);

[[nodiscard]] std::string run_id(const SweepRun& run);
// Runs on data that `inputs` lacks are left out.
[[nodiscard]] SweepPlan make_plan(const SweepFile& file, const std::map<std::string, SweepInput>& inputs);

// Names of all data that the sweeps use.
[[nodiscard]] std::set<std::string> data_names(const SweepFile& file);

// One of several parts of a sweep, counted from 1. Runs take turns in the order of their ids, so that parts are of one
// size, and neighbours in a grid, which take alike long, are spread over them.
struct Shard {
  int index = 1, count = 1;
};
// "2/8". Throws InputError.
[[nodiscard]] Shard parse_shard(const std::string& text);
// The runs of the shard, in the order of the plan.
[[nodiscard]] std::vector<SweepRun> runs_of(const SweepPlan& plan, const Shard& shard);

}  // namespace lodestone
