#include "experiments/mpi/job.h"

#include "experiments/metrics/cost/cost.h"

namespace lodestone {

OptionSpec timeout_option(double& seconds) {
  return OptionSpec{"--timeout", &seconds,
                    "Time that a process waits for a message of another one before it ends the job"}
      .between(1, 1e6)
      .of_type("SECONDS");
}

Progress job_progress(std::string label, const CommonOptions& common, int rank) {
  return Progress(std::move(label), common.quiet || rank != 0, Progress::Start::by_launcher);
}

std::vector<std::string> hosts_of(Ranks& ranks) {
  std::vector<std::string> hosts;
  for (const std::vector<std::string>& host : ranks.gather_texts({ranks.host()})) hosts.push_back(host.front());
  return hosts;
}

Json rank_rows(Ranks& ranks, const CpuClock& clock, RankCounts own) {
  struct Use {
    double cpu_seconds, waited_seconds;
    std::uint64_t bytes_sent, peak_bytes;
  };
  const Traffic& traffic = ranks.traffic();
  const std::vector<Use> uses =
      ranks.gather(Use{clock.elapsed().cpu_seconds, traffic.waited_seconds, traffic.bytes_sent, peak_resident_bytes()});
  const std::vector<std::string> hosts = hosts_of(ranks);
  Json rows = Json::array();
  for (std::size_t r = 0; r < uses.size(); ++r)
    rows.push_back({{"rank", r},
                    {"host", hosts[r]},
                    {"cpu_seconds", uses[r].cpu_seconds},
                    {"waited_seconds", uses[r].waited_seconds},
                    {"bytes_sent", uses[r].bytes_sent},
                    {"peak_bytes", uses[r].peak_bytes}});
  for (const auto& [name, count] : own) {
    const std::vector<std::uint64_t> counts = ranks.gather(count);
    for (std::size_t r = 0; r < counts.size(); ++r) rows[r][name] = counts[r];
  }
  return rows;
}

}  // namespace lodestone
