#include "experiments/mpi/job.h"

namespace lodestone {

OptionSpec timeout_option(double& seconds) {
  return OptionSpec{"--timeout", &seconds,
                    "Time that a process waits for a message of another one before it ends the job"}
      .between(1, 1e6)
      .of_type("SECONDS");
}

std::vector<std::string> hosts_of(Ranks& ranks) {
  std::vector<std::string> hosts;
  for (const std::vector<char>& host : ranks.gather_lists(std::vector<char>(ranks.host().begin(), ranks.host().end())))
    hosts.emplace_back(host.begin(), host.end());
  return hosts;
}

}  // namespace lodestone
