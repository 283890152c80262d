#include "python/bindings/json_values.h"

#include <string>

#include "experiments/command_line/exit_status.h"

namespace lodestone::python {
namespace {

py::object list_of(const Json& values) {
  py::list list;
  for (const Json& value : values) list.append(to_python(value));
  return list;
}

py::object dict_of(const Json& members) {
  py::dict dict;
  for (const auto& [name, value] : members.items()) dict[py::str(name)] = to_python(value);
  return dict;
}

}  // namespace

py::object to_python(const Json& value) {
  if (value.is_null()) return py::none();
  if (value.is_boolean()) return py::bool_(value.get<bool>());
  if (value.is_number_unsigned()) return py::int_(value.get<std::uint64_t>());
  if (value.is_number_integer()) return py::int_(value.get<std::int64_t>());
  if (value.is_number_float()) return py::float_(value.get<double>());
  if (value.is_string()) return py::str(value.string());
  return value.is_array() ? list_of(value) : dict_of(value);
}

Json to_json(const py::handle& value) {
  if (value.is_none()) return nullptr;
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
  if (PyIndex_Check(value.ptr()) != 0) return value.cast<std::int64_t>();
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::isinstance<py::dict>(value)) {
    Json members = Json::object();
    for (const auto& [name, member] : py::reinterpret_borrow<py::dict>(value))
      members[py::str(name).cast<std::string>()] = to_json(member);
    return members;
  }
  if (PyNumber_Check(value.ptr()) != 0) return py::float_(py::reinterpret_borrow<py::object>(value)).cast<double>();
  throw UsageError(py::repr(value).cast<std::string>() + " is not a number, a text or a truth value");
}

}  // namespace lodestone::python
