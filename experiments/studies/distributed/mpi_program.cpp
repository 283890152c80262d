#include "experiments/studies/distributed/mpi_program.h"

#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/base/error.h"
#include "core/files/text_file.h"
#include "experiments/command_line/child_process.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/run_file.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

bool can_run(const fs::path& file) {
  std::error_code unreadable;
  return fs::is_regular_file(file, unreadable) && access(file.c_str(), X_OK) == 0;
}

fs::path find_program() {
  if (const char* named = std::getenv("LODESTONE_MPI")) {
    if (can_run(named)) return named;
    throw UnsupportedError(
        describe(named, "", "is not a program that can be run", "set LODESTONE_MPI to lodestone-mpi"));
  }
  std::error_code unreadable;
  const fs::path folder = fs::read_symlink("/proc/self/exe", unreadable).parent_path();
  for (const char* place : {"lodestone-mpi", "mpi/lodestone-mpi"})
    if (can_run(folder / place)) return folder / place;
  throw UnsupportedError(describe("lodestone-mpi", "", "is not beside this program",
                                  "build it (scripts/setup distributed), or set LODESTONE_MPI to it"));
}

std::optional<fs::path> find_on_path(const std::string& name) {
  if (name.find('/') != std::string::npos) return can_run(name) ? std::optional<fs::path>(name) : std::nullopt;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (can_run(fs::path(folder) / name)) return fs::path(folder) / name;
  return std::nullopt;
}

// The launcher with its arguments.
ChildCommand launcher() {
  const char* named = std::getenv("LODESTONE_LAUNCHER");
  std::istringstream words(named != nullptr ? named : "mpirun");
  std::string name;
  words >> name;
  const std::optional<fs::path> program = find_on_path(name);
  if (!program)
    throw UnsupportedError(describe(name, "", "there is no such launcher of MPI",
                                    "install Open MPI (scripts/setup distributed), or set LODESTONE_LAUNCHER"));
  ChildCommand command;
  command.program = *program;
  for (std::string word; words >> word;) command.arguments.push_back(word);
  // For Open MPI 4, which refuses root unless it is told twice: a sweep that runs as root runs its ranks so, too.
  command.environment = {"OMPI_MCA_rmaps_base_oversubscribe=1", "OMPI_MCA_hwloc_base_binding_policy=none",
                         "OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1"};
  return command;
}

ChildEnd wait_for(ChildProcess& child, const RunContext& context) {
  constexpr int tick_milliseconds = 10;
  constexpr int patience = 500;  // ticks that a launcher has to end its ranks
  for (int ticks = 0; ticks < patience;) {
    if (const std::optional<ChildEnd> end = child.poll_end()) return *end;
    const bool cancelled = context.cancel && *context.cancel;
    if (cancelled && ticks++ == 0) child.signal(SIGTERM);
    poll(nullptr, 0, tick_milliseconds);
  }
  throw Cancelled{};
}

// The program's line about its failure, or else the last line of the launcher.
std::string reason_in(const fs::path& log) {
  std::ifstream in(log);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("lodestone-mpi: ")) return line;
    if (line.find_first_not_of("- \t") != std::string::npos) last = line;
  }
  return last;
}

}  // namespace

Json run_mpi_program(int ranks, std::vector<std::string> arguments, const RunContext& context) {
  const fs::path program = find_program();
  const RunFile result(context, "mpi.json"), log(context, "mpi.log");
  arguments.insert(arguments.end(), {"--json", result.path().string(), "--quiet"});
  ChildCommand command;
  if (ranks > 0) {
    command = launcher();
    command.arguments.insert(command.arguments.end(), {"-n", std::to_string(ranks), program.string()});
  } else {
    command.program = program;
  }
  command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
  ChildProcess child(std::move(command), log.path());
  const ChildEnd end = wait_for(child, context);
  check_cancelled(context);
  if (!end.succeeded())
    throw ResourceError(
        describe("lodestone-mpi " + arguments.front(), "", end.reason() + ": " + reason_in(log.path())));
  return Json::parse(read_text(result.path()));
}

}  // namespace lodestone
