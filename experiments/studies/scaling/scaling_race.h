// A race between numbers of workers that do the same job: they take turns, so that a machine that drifts does so for
// all of them alike.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "experiments/studies/rounds.h"
#include "experiments/studies/scaling/scaling_work.h"
#include "experiments/studies/verdict.h"
#include "parallel/scheduler/trace.h"

namespace lodestone {

// The job of one number of workers, bound to as many processors as there are of them, unless `affinity` leaves them to
// the system: one would wander over all, and two share a core or not.
class Contender {
 public:
  // `processors` to be bound to, see processors_of(); `times`: how much work.
  Contender(int workers, const std::vector<int>& processors, const IndexedMesh& mesh, const Parameters& parameters,
            const RunContext& context, int times);

  void warm_up();
  void run();

  struct Round {
    double begin = 0, end = 0;  // of the trace
    StageTime time;
  };
  int workers = 1;
  std::vector<int> processors;
  std::size_t bound = 0;  // processors, as the system says while the job runs
  std::shared_ptr<Trace> trace;
  std::unique_ptr<Scheduler> scheduler;
  std::unique_ptr<ScalingJob> job;
  std::vector<Round> rounds;
  std::vector<std::uint64_t> hashes;

  [[nodiscard]] Rounds times() const;
};

// The parameters of a race but `threads`; check_race() refuses what no race can run.
[[nodiscard]] std::vector<ParameterInfo> race_parameters();
void check_race(SettingVerdict& verdict, const Parameters& parameters);

// The processors for so many workers, as `affinity` says: on different cores as long as there are some, core by core,
// or all that there are.
[[nodiscard]] std::vector<int> processors_of(const Parameters& parameters, int workers);

// 1, 2, 4, ... and the most.
[[nodiscard]] std::vector<int> worker_counts(int most);

// After a round that warms up, `rounds` rounds each. If `weak`, every worker has as much to do as one alone.
[[nodiscard]] std::vector<Contender> race(const IndexedMesh& mesh, int most_workers, bool weak,
                                          const Parameters& parameters, const RunContext& context);

}  // namespace lodestone
