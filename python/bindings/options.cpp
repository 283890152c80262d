#include "python/bindings/options.h"

#include <utility>

#include "experiments/command_line/exit_status.h"

namespace lodestone::python {

Options::Options(std::string function, const py::kwargs& given) : function_(std::move(function)) {
  for (const auto& [name, value] : given) given_[name.cast<std::string>()] = value.cast<py::object>();
}

py::object Options::find(const std::string& name) {
  known_ += (known_.empty() ? "" : ", ") + name;
  const auto found = given_.find(name);
  if (found == given_.end()) return py::none();
  const py::object value = found->second;
  given_.erase(found);
  return value;
}

void Options::refuse(const std::string& name, const py::object& given) const {
  throw UsageError(function_ + ": " + name + ": " + py::repr(given).cast<std::string>() +
                   " is not a value of its kind; see help(lodestone." + function_ + ")");
}

void Options::finish() const {
  if (given_.empty()) return;
  throw UsageError(function_ + ": unknown option '" + given_.begin()->first + "'; the options are " + known_);
}

}  // namespace lodestone::python
