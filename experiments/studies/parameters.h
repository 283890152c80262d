// Parameters of an experiment: what there is to set, with kind, unit, range and default; and what a run has set.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/files/json.h"

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

}  // namespace lodestone
