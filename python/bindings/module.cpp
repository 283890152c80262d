// lodestone._lodestone: the module, and errors by kind.
#include <pybind11/pybind11.h>

#include <new>
#include <system_error>

#include "core/base/version.h"
#include "experiments/command_line/exit_status.h"
#include "python/bindings/bind.h"

namespace lodestone::python {
namespace {

// The exceptions by exit status; they live as long as the interpreter.
struct Kinds {
  py::object error, negative, input, usage, file, unsupported, resource;
};

py::object make_kind(py::module_& module, const char* name, const py::object& base, const char* meaning,
                     ExitStatus status) {
  py::dict members;
  members["__doc__"] = meaning;
  members["__module__"] = "lodestone";
  members["exit_status"] = static_cast<int>(status);
  const py::object type = py::reinterpret_borrow<py::object>(reinterpret_cast<PyObject*>(&PyType_Type));
  py::object kind = type(name, py::make_tuple(base), members);
  module.attr(name) = kind;
  return kind;
}

const Kinds* kinds = nullptr;

const py::object& kind_of(const std::exception& error) {
  switch (exit_status(error)) {
    case ExitStatus::negative:
      return kinds->negative;
    case ExitStatus::usage:
      return kinds->usage;
    case ExitStatus::input:
      return kinds->input;
    case ExitStatus::file:
      return kinds->file;
    case ExitStatus::unsupported:
      return kinds->unsupported;
    case ExitStatus::resource:
      return kinds->resource;
    default:
      return kinds->error;
  }
}

// Exceptions of the interpreter, and mistakes of ours, are left to pybind11.
void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    PyErr_SetString(kind_of(error).ptr(), error.what());
  } catch (const std::system_error& error) {
    PyErr_SetString(kind_of(error).ptr(), error.what());
  } catch (const std::bad_alloc&) {
    PyErr_SetString(kinds->resource.ptr(), "out of memory");
  } catch (const Cancelled&) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
  }
}

}  // namespace

void bind_errors(py::module_& module) {
  const py::object base = py::reinterpret_borrow<py::object>(PyExc_Exception);
  static Kinds all;  // never destroyed before the interpreter: see the release below
  using enum ExitStatus;
  all.error = make_kind(module, "Error", base, "Something went wrong; exit_status tells the kind as the command does.",
                        internal);
  const auto kind = [&](const char* name, const py::object& parent, const char* meaning, ExitStatus status) {
    return make_kind(module, name, parent, meaning, status);
  };
  all.negative = kind("NegativeResult", all.error, "The work is done, and the answer is no.", negative);
  all.input =
      kind("InputError", all.error, "The content of a file or an array is wrong, or a value is out of range.", input);
  all.usage = kind("UsageError", all.input, "An option is unknown, malformed or contradicts another one.", usage);
  all.file = kind("FileError", all.error, "A file cannot be read or written.", file);
  all.unsupported = kind("UnsupportedError", all.error, "This program or machine does not do that.", unsupported);
  all.resource = kind("ResourceError", all.error, "Memory or another limit does not suffice.", resource);
  kinds = new Kinds(all);
  all = {};
  py::register_exception_translator(translate);
}

}  // namespace lodestone::python

PYBIND11_MODULE(_lodestone, module) {
  using namespace lodestone::python;
  namespace py = pybind11;
  module.doc() = "The C++ side of the package lodestone, which documents it.";
  module.attr("__version__") = LODESTONE_VERSION;
  py::options plain;
  plain.disable_function_signatures();  // they do not show the keywords
  bind_errors(module);
  bind_meshes(module);
  bind_hierarchies(module);
  bind_selections(module);
  bind_pictures(module);
  bind_progressive(module);
  bind_experiments(module);
}
