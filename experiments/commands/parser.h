// The command line: parsed by the tables of the subcommands, and run.
#pragma once

#include "experiments/command_line/options.h"

namespace lodestone {

// Calls the subcommand that the command line names, and returns the exit status
// (experiments/command_line/exit_status.h). Errors are printed as one line on standard error.
[[nodiscard]] int run_command_line(const CommandTable& commands, int argc, char** argv);

}  // namespace lodestone
