// An experiment: its parameters with kind, unit, range and default, run(parameters) -> rows, and verify(rows); what
// does not verify is not reported.
//
// A run is one setting on one input, one repetition of it, in a process of its own: whatever it does to the heap, the
// threads and the caches ends with it, and repetitions of all settings can take turns. Accuracy does not change from
// one repetition to the next; it is measured in repetition 0 only.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/files/json.h"
#include "experiments/subjects/column_info.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// A number, whole number, text or truth value: scalars only.
using ParameterValue = Json;

// Texts that a parameter takes besides its choices.
struct OtherTexts {
  std::string what;  // in words, as "a recorded path (.json)"
  // The text in the form in which equal ones are equal; none: it is not such a text. Throws InputError that says more.
  std::function<std::optional<std::string>(const std::string&)> usual_form;
  // They name files, relative to the sweep file, and this throws Error for one that is missing or wrong. Null: they
  // name none.
  std::function<void(const std::string& path)> look_into = {};
};

struct ParameterInfo {
  std::string name;
  ParameterValue default_value;  // its type is the parameter's; a whole number is taken for a number, not the reverse
  std::string unit;              // "pixels", "cell sizes", ...; empty: none
  std::string description;       // half a sentence, for the list of experiments and the report
  double least = -std::numeric_limits<double>::infinity();  // of numbers
  double most = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices;  // of texts; empty: any
  std::optional<OtherTexts> others = {};
  bool condition = false;  // under which something is measured: settings compete only where conditions are equal
};

[[nodiscard]] inline ParameterInfo as_condition(ParameterInfo info) {
  info.condition = true;
  return info;
}

// Its choices and what else it may be, separated by commas; empty: any text, or no text.
[[nodiscard]] std::string known_texts(const ParameterInfo& info);

[[nodiscard]] bool names_file(const ParameterInfo& info, const ParameterValue& value);

// All parameters of one run, resolved: each of the experiment's, and no other.
class Parameters {
 public:
  // Throws InputError, with the name and the remedy: for a name that `known` lacks, a value of another kind, out of
  // range, or not among its texts; files are not looked into. What `given` leaves out has its default.
  Parameters(const std::vector<ParameterInfo>& known, const Json& given);

  [[nodiscard]] double number(const std::string& name) const { return values_.at(name).get<double>(); }
  [[nodiscard]] int integer(const std::string& name) const { return values_.at(name).get<int>(); }
  [[nodiscard]] bool flag(const std::string& name) const { return values_.at(name).get<bool>(); }
  [[nodiscard]] std::string text(const std::string& name) const { return values_.at(name).get<std::string>(); }

  // An object with sorted keys: the same parameters have the same text.
  [[nodiscard]] const Json& json() const { return values_; }

 private:
  Json values_;
};

struct RunContext {
  std::string input;      // file of the data; empty: the experiment takes none
  std::string directory;  // of the run, exists; scratch files go there and are removed, pictures stay
  int repetition = 0;     // from 0
  const CancelFlag* cancel = nullptr;
  std::function<void(double)> progress = [](double) {};  // share done
};

// A fault of a setting.
struct SettingFault {
  std::vector<std::string> parameters;  // that are at odds; told at the last one that is given
  std::string what;                     // in words, with the remedy
  bool idle = false;                    // the one parameter has no effect beside the others
};

struct Experiment {
  std::string name;
  std::string question;  // what it answers, as a sentence with a question mark
  bool takes_input = true;
  std::vector<ParameterInfo> parameters = {};
  std::vector<ColumnInfo> columns;  // every column that a row can have
  std::function<std::vector<Row>(const Parameters&, const RunContext&)> run;
  // The faults of the rows, in words; empty: they may be reported.
  std::function<std::vector<std::string>(const Parameters&, const std::vector<Row>&)> verify;
  // Contradictions of a setting, told before anything is run: run() may rely on there being none. Empty: none can be.
  std::function<std::vector<SettingFault>(const Parameters&)> check{};
};

// The experiments, a file each. `probe` has known results and every way to fail: it tries out a machine, a cluster or
// the sweep itself.
[[nodiscard]] Experiment build_experiment();
[[nodiscard]] Experiment distributed_experiment();
[[nodiscard]] Experiment effects_experiment();
[[nodiscard]] Experiment families_experiment();
[[nodiscard]] Experiment flight_experiment();
[[nodiscard]] Experiment probe_experiment();
[[nodiscard]] Experiment progressive_experiment();
[[nodiscard]] Experiment spherical_experiment();
[[nodiscard]] Experiment ranks_experiment();
[[nodiscard]] Experiment raster_experiment();
[[nodiscard]] Experiment reconstruct_experiment();
[[nodiscard]] Experiment scaling_experiment();
[[nodiscard]] Experiment schedule_experiment();
[[nodiscard]] Experiment shells_experiment();
[[nodiscard]] Experiment systems_experiment();
[[nodiscard]] Experiment table_experiment();

// Makes an experiment known to `lodestone experiments` and to sweeps. Throws InputError for a name that is taken or
// cannot be one (core/base/registry.h), and for an experiment without run, verify or columns. To be called before any
// is used.
void add_experiment(Experiment experiment);

// The names of all experiments, sorted.
[[nodiscard]] std::vector<std::string> experiment_names();
// Throws InputError that lists the known ones.
[[nodiscard]] const Experiment& find_experiment(const std::string& name);

}  // namespace lodestone
