// The command line: parsed by the tables of the subcommands, and run.
#pragma once

#include <string>

#include "experiments/command_line/options.h"

namespace lodestone {

struct ProgramVoice {
  std::string name = "lodestone";  // in help and errors
  bool silent = false;             // errors and help are not printed: another process of the same job does so
};

// Calls the subcommand that the command line names, and returns the exit status
// (experiments/command_line/exit_status.h). Errors are printed as one line on standard error. Throws std::bad_alloc.
[[nodiscard]] int run_command_line(const CommandTable& commands, int argc, char** argv, const ProgramVoice& voice = {});

// Returns the exit status of `run`, all that the program does. Memory that runs out in it, or in a function that
// may not throw, is one line on standard error, leaves no temporary file, and ends with the status of a resource.
[[nodiscard]] int guard_memory(int (*run)(int, char**), int argc, char** argv);

}  // namespace lodestone
