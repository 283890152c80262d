// The program lodestone-mpi as a child process, under the launcher of its ranks or alone.
#pragma once

#include <string>
#include <vector>

#include "core/files/json.h"
#include "experiments/studies/experiment.h"

namespace lodestone {

// Runs a subcommand of it in so many processes, or without a launcher where ranks is 0, and returns what it writes for
// --json. The program is $LODESTONE_MPI or lies beside this one; the launcher is $LODESTONE_LAUNCHER, a program with
// arguments, or mpirun. Open MPI is told that ranks may share processors, and to bind none of them. Leaves no file in
// the run's folder. Throws UnsupportedError where one of the two is missing, ResourceError with its line when the
// program fails, Cancelled.
[[nodiscard]] Json run_mpi_program(int ranks, std::vector<std::string> arguments, const RunContext& context);

}  // namespace lodestone
