// Keyword arguments of a function that fill the fields of a config, whose defaults they leave alone.
#pragma once

#include <pybind11/pybind11.h>

#include <map>
#include <string>

namespace lodestone::python {

namespace py = pybind11;

class Options {
 public:
  // A UsageError names the function.
  Options(std::string function, const py::kwargs& given);

  // None is the same as not given. Throws UsageError for a value of another kind.
  template <class Value>
  bool take(const std::string& name, Value& value) {
    const py::object given = find(name);
    if (given.is_none()) return false;
    try {
      value = given.cast<Value>();
    } catch (const py::cast_error&) {
      refuse(name, given);
    }
    return true;
  }
  // A value of kind Given that `parse` makes the field of.
  template <class Given, class Value, class Parse>
  void take(const std::string& name, Value& value, const Parse& parse) {
    if (Given given{}; take(name, given)) value = parse(given);
  }

  // Throws UsageError for a keyword that was not taken, with those that there are.
  void finish() const;

 private:
  [[nodiscard]] py::object find(const std::string& name);
  [[noreturn]] void refuse(const std::string& name, const py::object& given) const;

  std::string function_;
  std::map<std::string, py::object> given_;
  std::string known_;
};

}  // namespace lodestone::python
