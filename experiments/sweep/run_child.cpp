#include "experiments/sweep/run_child.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>

#include "core/base/error.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/sweep/files.h"
#include "experiments/sweep/manifest.h"
#include "experiments/sweep/program_identity.h"
#include "experiments/sweep/run_folder.h"
#include "parallel/scheduler/processors.h"
#include "render/backends/gl/device/graphics_driver.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

// A few lines a second, whatever the experiment does. A parent that does not listen is not waited for.
class Reporter {
 public:
  explicit Reporter(int descriptor) : descriptor_(descriptor) {}
  void operator()(double share) {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(200)) return;
    last_ = now;
    const std::string line = fmt::format("{:.4f}\n", share);
    [[maybe_unused]] const ssize_t written = write(descriptor_, line.data(), line.size());
  }

 private:
  int descriptor_;
  std::chrono::steady_clock::time_point last_;
};

std::string lines_of(const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) text += row.dump() + "\n";
  return text;
}

bool is_column(const Experiment& experiment, const std::string& name) {
  return std::ranges::find(experiment.columns, name, &ColumnInfo::name) != experiment.columns.end();
}

// The values that a reader can use, of rows that are not as they have to be.
std::vector<Row> readable(const Experiment& experiment, std::vector<Row> rows) {
  for (Row& row : rows) {
    if (!row.is_object()) row = Row::object();
    std::erase_if(row.items(), [&](const auto& member) {
      return member.second.is_structured() || !is_column(experiment, member.first);
    });
  }
  return rows;
}

// `machine` as it was before the run, whose own load it does not have. What the run has loaded is known afterwards.
Json manifest(const Json& machine) {
  Json facts = program_facts();
  facts.update(machine);
  facts["peak_bytes"] = peak_resident_bytes();
  if (const auto driver = last_graphics_driver())
    facts["gl"] = {{"vendor", driver->vendor}, {"renderer", driver->renderer}, {"version", driver->version}};
  return facts;
}

// A run that is not pinned has as many processors as it asks for, too: more threads would share them.
void check_threads(const Json& parameters) {
  const auto threads = parameters.value("threads", std::size_t{0}), processors = allowed_processors().size();
  if (threads > processors)
    throw InputError(
        fmt::format("threads = {}: there are {} processors that this process may use", threads, processors));
}

// Rows go into the work folder; what is wrong with them, or with the run, is returned.
std::optional<Fault> run_experiment(const Json& job, const WorkFolder& work, RunContext& context) {
  try {
    // The parent's executable is this one, whatever has become of its file; libraries are loaded anew.
    if (job.at("program") != program_hash())
      return Fault{"error", {"the program's libraries changed since the sweep began; run again with --resume"}};
    const Experiment& experiment = find_experiment(job.at("experiment").string());
    const Parameters parameters(experiment.parameters, job.at("parameters"));
    check_threads(job.at("parameters"));
    CheckedRows checked = run_checked(experiment, parameters, context);
    write_aside(work.rows(), lines_of(readable(experiment, std::move(checked.rows))));
    if (!checked.faults.empty()) return Fault{"verify", std::move(checked.faults)};
    return {};
  } catch (const Cancelled&) {
    throw;
  } catch (const std::bad_alloc&) {
    return Fault{"error", {"out of memory"}};
  } catch (const std::exception& error) {
    return Fault{"error", {error.what()}};
  }
}

}  // namespace

std::vector<std::string> faulty_values(const Experiment& experiment, const std::vector<Row>& rows) {
  std::vector<std::string> messages;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i].is_object()) {
      messages.push_back(fmt::format("row {} is not an object", i));
      continue;
    }
    for (const auto& [name, value] : rows[i].items()) {
      if (!is_column(experiment, name))
        messages.push_back(fmt::format("row {}: {} is not a column of {}", i, name, experiment.name));
      else if (value.is_structured())
        messages.push_back(fmt::format("row {}: {} is not a single value", i, name));
      else if (value.is_number_float() && !std::isfinite(value.get<double>()))
        messages.push_back(fmt::format("row {}: {} is not finite", i, name));
    }
  }
  return messages;
}

CheckedRows run_checked(const Experiment& experiment, const Parameters& parameters, const RunContext& context) {
  CheckedRows checked{experiment.run(parameters, context), {}};
  checked.faults = faulty_values(experiment, checked.rows);
  if (checked.faults.empty()) checked.faults = experiment.verify(parameters, checked.rows);
  return checked;
}

void run_child(const fs::path& folder, int report, const CancelFlag& cancel) {
  const WorkFolder work{folder};
  const Json job = read_json(work.job());
  if (!job.is_object()) throw InputError(describe(work.job().string(), "", "is not a job of a sweep"));
  pin_to(job.at("processors").get<std::vector<int>>());
  const Json machine = machine_facts();
  RunContext context;
  context.input = job.at("input").string();
  context.directory = work.scratch().string();
  context.repetition = job.at("repetition").get<int>();
  context.cancel = &cancel;
  context.progress = Reporter(report);
  const std::optional<Fault> fault = run_experiment(job, work, context);
  if (cancel) throw Cancelled{};
  if (fault) write_aside(work.fault(), to_json(*fault).dump());
  write_aside(work.manifest(), manifest(machine).dump());
}

}  // namespace lodestone
