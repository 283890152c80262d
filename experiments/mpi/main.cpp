// The `lodestone-mpi` command, as mpirun or srun starts it in each process of a job.
#include <csignal>

#include "experiments/commands/command.h"
#include "experiments/commands/parser.h"
#include "experiments/large_memory.h"
#include "experiments/mpi/job.h"
#include "experiments/mpi/plan.h"

namespace lodestone {
namespace {

int run_commands(int argc, char** argv) {
  MpiTransport transport(&argc, &argv);
  CommandTable commands;
  add_build_job(commands, transport);
  add_export_job(commands, transport);
  add_verify_job(commands, transport);
  add_plan(commands, transport.rank() == 0);
  install_signal_handlers();
  allow_many_files();
  set_interrupt_line(transport.rank() == 0 ? "lodestone-mpi: interrupted; no unfinished file was left\n" : "");
  const int status = run_command_line(commands, argc, argv, {.name = "lodestone-mpi", .silent = transport.rank() != 0});
  // The launcher ends all processes when the first has ended with an error: the others end with theirs.
  set_interrupt_line("");
  if (status != 0) std::signal(SIGTERM, SIG_IGN);
  return status;
}

}  // namespace
}  // namespace lodestone

int main(int argc, char** argv) {
  lodestone::return_large_memory();
  return lodestone::guard_memory(lodestone::run_commands, argc, argv);
}
