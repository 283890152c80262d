#include <fmt/core.h>
#include <poll.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <new>

#include "core/base/error.h"
#include "experiments/studies/experiment.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace probe_study {

void wait(double seconds, const RunContext& context) {
  const Stopwatch waited;
  while (waited.seconds() < seconds) {
    if (context.cancel && *context.cancel) throw Cancelled{};
    context.progress(waited.seconds() / seconds);
    poll(nullptr, 0, 5);
  }
}

void fail(const std::string& failure, int repetition) {
  if (failure == "error") throw InputError("probe: an error was asked for");
  if (failure == "unsupported") throw UnsupportedError("backend 'probe' is not available here; take another one");
  if (failure == "memory") throw std::bad_alloc();
  if (failure == "cancelled") throw Cancelled{};
  if (failure == "crash") std::abort();
  if (failure == "killed") std::raise(SIGKILL);
  if (failure == "exit") std::_Exit(3);
  if (failure == "first" && repetition == 0) throw InputError("probe: the first repetition fails");
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  const std::string failure = parameters.text("failure");
  const std::filesystem::path folder(context.directory);
  std::ofstream(folder / "scratch.tmp") << "scratch";
  fmt::print("probe at work, repetition {}\n", context.repetition);
  std::fflush(stdout);
  wait(parameters.number("seconds"), context);
  fail(failure, context.repetition);
  const double x = parameters.number("x");
  std::vector<Row> rows;
  for (int i = 0; i < parameters.integer("rows"); ++i) {
    const double power = failure == "not-finite" ? std::numeric_limits<double>::quiet_NaN() : x * (i + 1);
    rows.push_back({{"number", i}, {"multiple", power}, {"bytes", std::filesystem::file_size(context.input)}});
    if (failure == "verify") rows.back()["multiple"] = -1;
    if (failure == "column") rows.back()["surprise"] = 1;
  }
  return rows;
}

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  std::vector<std::string> wrong;
  for (const Row& row : rows) {
    const double expected = parameters.number("x") * (row.at("number").get<int>() + 1);
    if (row.at("multiple").get<double>() != expected)
      wrong.push_back(
          fmt::format("row {}: {} is not {:g}", row.at("number").get<int>(), row.at("multiple").dump(), expected));
  }
  return wrong;
}

}  // namespace probe_study

Experiment probe_experiment() {
  using namespace probe_study;
  Experiment probe;
  probe.name = "probe";
  probe.question = "Does a sweep work here? (Measures nothing: known numbers, and failures on request.)";
  probe.parameters = {{"x", 1.0, "", "number whose multiples the rows hold", -1e9, 1e9, {}},
                      {"rows", 3, "", "how many", 0, 100'000, {}},
                      {"seconds", 0.0, "s", "to wait before", 0, 3600, {}},
                      {"threads", 1, "", "processors to be pinned to", 0, 1024, {}},
                      {"failure",
                       "none",
                       "",
                       "what goes wrong",
                       0,
                       0,
                       {"none", "verify", "not-finite", "column", "error", "unsupported", "memory", "cancelled",
                        "crash", "killed", "exit", "first"}}};
  probe.columns = {{"number", "", "of the row, from 0", ColumnInfo::Kind::label},
                   {"multiple", "", "x times the number of the row, counted from 1", ColumnInfo::Kind::accuracy},
                   {"bytes", "bytes", "size of the input", ColumnInfo::Kind::count}};
  probe.run = probe_study::run;
  probe.verify = verify;
  return probe;
}

}  // namespace lodestone
