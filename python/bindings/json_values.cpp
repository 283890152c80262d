#include "python/bindings/json_values.h"

#include <string>

#include "experiments/command_line/exit_status.h"

namespace lodestone::python {
namespace {

py::object list_of(const nlohmann::json& values) {
  py::list list;
  for (const nlohmann::json& value : values) list.append(to_python(value));
  return list;
}

py::object dict_of(const nlohmann::json& members) {
  py::dict dict;
  for (const auto& [name, value] : members.items()) dict[py::str(name)] = to_python(value);
  return dict;
}

}  // namespace

py::object to_python(const nlohmann::json& value) {
  using Type = nlohmann::json::value_t;
  switch (value.type()) {
    case Type::boolean:
      return py::bool_(value.get<bool>());
    case Type::number_integer:
      return py::int_(value.get<std::int64_t>());
    case Type::number_unsigned:
      return py::int_(value.get<std::uint64_t>());
    case Type::number_float:
      return py::float_(value.get<double>());
    case Type::string:
      return py::str(value.get_ref<const std::string&>());
    case Type::array:
      return list_of(value);
    case Type::object:
      return dict_of(value);
    default:
      return py::none();
  }
}

nlohmann::json to_json(const py::handle& value) {
  if (value.is_none()) return nullptr;
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
  if (PyIndex_Check(value.ptr()) != 0) return value.cast<std::int64_t>();
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::isinstance<py::dict>(value)) {
    nlohmann::json members = nlohmann::json::object();
    for (const auto& [name, member] : py::reinterpret_borrow<py::dict>(value))
      members[py::str(name).cast<std::string>()] = to_json(member);
    return members;
  }
  if (PyNumber_Check(value.ptr()) != 0) return py::float_(py::reinterpret_borrow<py::object>(value)).cast<double>();
  throw UsageError(py::repr(value).cast<std::string>() + " is not a number, a text or a truth value");
}

}  // namespace lodestone::python
