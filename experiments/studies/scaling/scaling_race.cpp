#include "experiments/studies/scaling/scaling_race.h"

#include <algorithm>

#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/processors.h"
#include "render/position_map/map_view.h"

namespace lodestone {

Contender::Contender(int n, const std::vector<int>& to_use, const IndexedMesh& mesh, const Parameters& parameters,
                     const RunContext& context, int times)
    : workers(n),
      processors(to_use),
      trace(std::make_shared<Trace>(n)),
      scheduler(make_tracing_scheduler(make_tbb_scheduler(n), trace)),
      job(make_scaling_job(mesh, parameters, context, times, *scheduler)) {}

void Contender::warm_up() {
  const BoundThreads binding(processors);
  job->prepare();
  job->run();
}

void Contender::run() {
  const BoundThreads binding(processors);
  bound = allowed_processors().size();
  job->prepare();
  const double begin = trace->now();
  const CpuClock clock;
  job->run();
  const StageTime time = clock.elapsed();
  rounds.push_back({begin, trace->now(), time});
  hashes.push_back(job->hash());
}

Rounds Contender::times() const {
  Rounds times;
  for (const Round& round : rounds) times.add(round.time);
  return times;
}

std::vector<ParameterInfo> race_parameters() {
  std::vector<ParameterInfo> list{
      rounds_parameter(5),
      as_condition({"task", "build", "", "what the workers do", 0, 0, scaling_tasks()}),
      as_condition(
          {"affinity",
           "cores",
           "",
           "cores: workers on different cores as long as there are some; threads: core by core; free: anywhere",
           0,
           0,
           {"cores", "threads", "free"}}),
      as_condition({"resolution", 256.0, "pixels", "of reconstruct, along the longest side", 8, largest_map_side, {}}),
      as_condition({"frames", 8, "", "of raster, once around the model", 2, 10000, {}}),
  };
  append(list, build_parameters());
  append(list, {as_condition({"width", 640, "pixels", "of raster", 16, 16384, {}}),
                as_condition({"height", 360, "pixels", "of raster", 16, 16384, {}})});
  return list;
}

void check_race(SettingVerdict& verdict, const Parameters& parameters) {
  const std::string name = parameters.text("task"), task = assignment(parameters, "task");
  verdict.idle(name != "reconstruct", "resolution", task);
  for (const char* of_raster : {"frames", "width", "height"}) verdict.idle(name != "raster", of_raster, task);
  const bool builds = name == "build" || name == "raster";
  for (const ParameterInfo& info : build_parameters()) verdict.idle(!builds, info.name, task);
  if (builds) check_build(verdict, parameters);
}

std::vector<int> processors_of(const Parameters& parameters, int workers) {
  const std::string affinity = parameters.text("affinity");
  std::vector<int> all = allowed_processors();
  if (affinity == "free") return all;
  all = affinity == "cores" ? one_per_core_first(all) : core_by_core(all);
  all.resize(std::min(all.size(), static_cast<std::size_t>(workers)));
  return all;
}

std::vector<int> worker_counts(int most) {
  std::vector<int> counts;
  for (int n = 1; n < most; n *= 2) counts.push_back(n);
  counts.push_back(most);
  return counts;
}

std::vector<Contender> race(const IndexedMesh& mesh, int most_workers, bool weak, const Parameters& parameters,
                            const RunContext& context) {
  std::vector<Contender> contenders;
  for (const int n : worker_counts(most_workers))
    contenders.emplace_back(n, processors_of(parameters, n), mesh, parameters, context, weak ? n : 1);
  for (Contender& contender : contenders) contender.warm_up();
  const int rounds = parameters.integer("rounds");
  for (int round = 0; round < rounds; ++round) {
    for (Contender& contender : contenders) {
      check_cancelled(context);
      contender.run();
    }
    context.progress(static_cast<double>(round + 1) / rounds);
  }
  return contenders;
}

}  // namespace lodestone
