// lodestone-mpi plan: how a build would spread over many ranks, from its finished file (docs/cluster.md).
#pragma once

#include "experiments/command_line/options.h"

namespace lodestone {

// `works`: false in all processes of a job but one.
void add_plan(CommandTable& commands, bool works);

}  // namespace lodestone
