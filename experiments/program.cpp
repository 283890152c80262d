#include "experiments/program.h"

#include "experiments/command_line/version.h"
#include "experiments/commands/command.h"
#include "experiments/commands/parser.h"
#include "experiments/large_memory.h"

namespace lodestone {
namespace {

std::string_view given_commit;

// All that may run out of memory.
int run_commands(int argc, char** argv) {
  set_program_commit(given_commit);
  CommandTable commands;
  add_generate(commands);
  add_build(commands);
  add_info(commands);
  add_verify(commands);
  add_compare(commands);
  add_render(commands);
  add_export(commands);
  add_view(commands);
  add_reconstruct(commands);
  add_progressive(commands);
  add_spherical(commands);
  add_lod(commands);
  add_page(commands);
  add_report(commands);
  add_sweep(commands);
  add_merge(commands);
  add_experiments(commands);
  add_completion(commands);
  add_manual(commands);
  install_signal_handlers();
  allow_many_files();
  return run_command_line(commands, argc, argv);
}

}  // namespace

int run_program(int argc, char** argv, std::string_view commit) {
  keep_large_memory();
  given_commit = commit;
  return guard_memory(run_commands, argc, argv);
}

}  // namespace lodestone
