// lodestone-mpi build: one .lode file by all processes of an MPI job (docs/cluster.md).
#pragma once

#include "experiments/command_line/options.h"
#include "parallel/distributed/mpi_transport.h"

namespace lodestone {

// The transport outlives the table.
void add_build_job(CommandTable& commands, MpiTransport& transport);

}  // namespace lodestone
