// Experiments: their list, and one run of one of them.
#include <pybind11/stl.h>

#include "experiments/command_line/exit_status.h"
#include "experiments/studies/experiment.h"
#include "experiments/sweep/run_child.h"
#include "python/bindings/bind.h"
#include "python/bindings/docs.h"
#include "python/bindings/json_values.h"

namespace lodestone::python {
namespace {

py::dict questions() {
  py::dict list;
  for (const std::string& name : experiment_names()) list[py::str(name)] = find_experiment(name).question;
  return list;
}

void refuse_faults(const Experiment& experiment, const Parameters& parameters) {
  if (!experiment.check) return;
  for (const SettingFault& fault : experiment.check(parameters))
    if (!fault.idle) throw UsageError(experiment.name + ": " + fault.what);
}

// `directory` exists; scratch files and pictures go there.
py::object run_experiment(const std::string& name, const py::dict& given, const std::string& directory,
                          const py::kwargs& more) {
  Options options("run_experiment", more);
  const Experiment& experiment = find_experiment(name);
  const Parameters parameters(experiment.parameters, to_json(given));
  refuse_faults(experiment, parameters);
  RunContext context;
  context.directory = directory;
  options.take("input", context.input);
  LongCall call(options, LongCall::Threads::none);
  options.finish();
  if (experiment.takes_input == context.input.empty())
    throw UsageError(name + (experiment.takes_input ? ": give the mesh as input" : ": takes no input"));
  context.cancel = call.cancel();
  context.progress = [&](double share) { call.report("running", share); };
  const CheckedRows checked = call.run([&] { return run_checked(experiment, parameters, context); });
  if (!checked.faults.empty()) throw NegativeResult(experiment.name + ": " + checked.faults.front());
  return to_python(checked.rows);
}

}  // namespace

void bind_experiments(py::module_& module) {
  module.def("experiments", &questions, doc::experiments);
  module.def("run_experiment", &run_experiment, py::arg("name"), py::arg("parameters"), py::arg("directory"),
             doc::run_experiment);
}

}  // namespace lodestone::python
