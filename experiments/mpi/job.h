// Commands that all processes of an MPI job run together.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "experiments/command_line/exit_status.h"
#include "experiments/command_line/options.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "parallel/distributed/messages/mpi_transport.h"
#include "parallel/distributed/messages/ranks.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {

// The parts of a command; its options have a `double timeout`.
template <class Options>
struct JobCommand {
  OptionTable (*declare)(Options&);
  void (*check)(const Options&);  // throws UsageError; may be null
  void (*run)(const Options&, const CommonOptions&, Transport&);
};

[[nodiscard]] OptionSpec timeout_option(double& seconds);

// One bar of all processes, by the first, on the terminal that the launcher was started from, if that is on its
// machine.
[[nodiscard]] Progress job_progress(std::string label, const CommonOptions& common, int rank);

// The machine of each process, at all of them.
[[nodiscard]] std::vector<std::string> hosts_of(Ranks& ranks);

// Counts of a rank by name; all ranks have the same names.
using RankCounts = std::initializer_list<std::pair<const char*, std::uint64_t>>;
// A row for each process, at all of them: host, processor seconds since the clock, memory, messages so far, and counts.
[[nodiscard]] Json rank_rows(Ranks& ranks, const CpuClock& clock, RankCounts own);

// The transport outlives the table.
template <class Options>
void add_job(CommandTable& commands, MpiTransport& transport, CommandInfo info, const JobCommand<Options>& job) {
  struct Both {
    Options own;
    CommonOptions common;
  };
  const auto both = std::make_shared<Both>();
  const auto run = [both, job, &transport] {
    try {
      if (job.check) job.check(both->own);
      transport.set_timeout(both->own.timeout);
      run_rank(transport, [&] { job.run(both->own, both->common, transport); });
    } catch (...) {
      set_interrupt_line("");  // the launcher ends those that are not through yet: the error has been told
      throw;
    }
  };
  info.threads_help = "Number of threads of each process; 0 takes all that it may run on";
  add_command(commands, info, both->common, job.declare(both->own), run);
}

void add_build_job(CommandTable& commands, MpiTransport& transport);
void add_export_job(CommandTable& commands, MpiTransport& transport);
void add_verify_job(CommandTable& commands, MpiTransport& transport);

}  // namespace lodestone
