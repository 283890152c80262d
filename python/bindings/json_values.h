// Values of JSON, such as rows of results, as those of Python, and back.
#pragma once

#include <pybind11/pybind11.h>

#include "core/files/json.h"

namespace lodestone::python {

namespace py = pybind11;

// Objects become dicts, arrays lists, null None.
[[nodiscard]] py::object to_python(const Json& value);
// Throws UsageError for what JSON does not have.
[[nodiscard]] Json to_json(const py::handle& value);

}  // namespace lodestone::python
