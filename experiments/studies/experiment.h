// An experiment: run(parameters) -> rows, and verify(rows); what does not verify is not reported.
//
// A run is one setting on one input, one repetition of it, in a process of its own: whatever it does to the heap, the
// threads and the caches ends with it, and repetitions of all settings can take turns. Accuracy does not change from
// one repetition to the next; it is measured in repetition 0 only.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/studies/parameters.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// What a row says: name -> number, text, truth value or null (not measured in this row). A flat object.
using Row = nlohmann::json;

// What a setting has to say for a column to be measured: one of these conditions.
struct ColumnNeed {
  struct Condition {
    std::string parameter;
    ParameterValue value;
    bool is = true;  // false: any other value
  };
  std::vector<Condition> any;
};

// A column that a row may have besides the parameters.
struct ColumnInfo {
  // Of accuracy less is better, of quality (PSNR, SSIM) more.
  enum class Kind { label, accuracy, quality, cost, count };

  std::string name;
  std::string unit;     // "s", "% of the diagonal", "pixels", ...; empty: none
  std::string meaning;  // for the report
  Kind kind = Kind::count;
  std::vector<ColumnNeed> needs{};  // all of them; empty: every setting has it
};

struct RunContext {
  std::string input;      // file that the data's name stands for; empty: the experiment takes none
  std::string directory;  // of the run, exists; scratch files go there and are removed, pictures stay
  int repetition = 0;     // from 0
  const CancelFlag* cancel = nullptr;
  std::function<void(double)> progress = [](double) {};  // share done
};

// What is wrong with a setting.
struct SettingFault {
  std::vector<std::string> parameters;  // that are at odds; told at the last one that is given
  std::string what;                     // in words, with the remedy
  bool idle = false;                    // the one parameter has no effect beside the others
};

struct Experiment {
  std::string name;
  std::string question;  // what it answers, as a sentence with a question mark
  bool takes_input = true;
  std::vector<ParameterInfo> parameters;
  std::vector<ColumnInfo> columns;  // every column that a row can have
  std::function<std::vector<Row>(const Parameters&, const RunContext&)> run;
  // What is wrong with the rows, in words; empty: they may be reported.
  std::function<std::vector<std::string>(const Parameters&, const std::vector<Row>&)> verify;
  // What contradicts itself, told before anything is run: run() may count on there being nothing. Empty: nothing can.
  std::function<std::vector<SettingFault>(const Parameters&)> check{};
};

// All experiments, by name. Names are unique.
[[nodiscard]] const std::vector<Experiment>& experiments();
// Throws InputError that lists the known ones.
[[nodiscard]] const Experiment& find_experiment(const std::string& name);

}  // namespace lodestone
