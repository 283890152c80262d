#include "parallel/distributed/building/build_distributed.h"

#include <memory>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "parallel/distributed/building/stored_levels.h"
#include "parallel/distributed/distributed_clean.h"
#include "parallel/distributed/rank_blocks.h"
#include "parallel/distributed/rank_finest.h"
#include "parallel/distributed/rank_save.h"
#include "parallel/distributed/route_triangles.h"
#include "parallel/hierarchy/build_blocks.h"

namespace lodestone {
namespace {

void check(const DistributedConfig& config) {
  check_config(config.build);
  if (config.build.refine) throw UnsupportedError("splitting long edges needs the whole mesh on one machine");
  if (config.build.order_cells) throw UnsupportedError("compressed files are not written by several ranks");
}

void check(const MeshStream& stream) {
  if (stream.has_attributes())
    throw UnsupportedError(describe(stream.name(), "",
                                    "has attributes of vertices, which several ranks do not build: wedges of a vertex "
                                    "would have to be welded across them",
                                    "leave them out (--no-attributes), or use lodestone build"));
  if (stream.vertex_count() >= FinestVertices::shared_flag)
    throw ResourceError(describe(stream.name(), "", "has more than 2^31 vertices; vertex ids have 32 bits"));
  if (stream.triangle_count() >= 0xffff'ffffu)
    throw ResourceError(describe(stream.name(), "", "more triangles than 32-bit numbers reach", "split the model"));
}

RankMemory memory_of(const RankInput& input, const DistributedConfig& config, Ranks& ranks, Scheduler& scheduler) {
  RankLimit limit = config.limit;
  if (limit.scratch.empty()) limit.scratch = config.output.parent_path();
  return {input, limit, config.build, ranks, scheduler.workers()};
}

void describe_input(const CleanSlices& clean, Hierarchy& head) {
  head.transform = clean.transform;
  head.provenance.repairs = clean.repairs;
  head.provenance.input_vertices = clean.vertices_left.total();
  head.provenance.input_triangles = clean.triangles_left;
}

// Measures the stages of a rank.
class Stages {
 public:
  Stages(const DistributedConfig& config, Ranks& ranks, Scheduler& scheduler)
      : config_(config), ranks_(ranks), scheduler_(scheduler) {}

  template <class Work>
  auto run(const char* label, const Work& work) {
    if (config_.on_stage) config_.on_stage(label);
    scheduler_.name_work(distributed_stages[next_]);
    clock_ = CpuClock();
    before_ = ranks_.traffic();
    auto out = work();
    measure();
    ++next_;
    return out;
  }

  // The reports of all ranks, when their last stage is nearly done.
  [[nodiscard]] std::vector<RankReport> gather() {
    measure();
    std::vector<RankReport> all = ranks_.gather(report);
    if (config_.last_words) config_.last_words();
    return all;
  }

  RankReport report;

 private:
  void measure() { report.stages[next_] = {clock_.elapsed(), ranks_.traffic().since(before_)}; }

  const DistributedConfig& config_;
  Ranks& ranks_;
  Scheduler& scheduler_;
  std::size_t next_ = 0;
  CpuClock clock_;
  Traffic before_;
};

}  // namespace

RankStage RankReport::total() const {
  RankStage sum;
  for (const RankStage& stage : stages) {
    sum.time += stage.time;
    sum.traffic += stage.traffic;
  }
  return sum;
}

DistributedResult build_distributed(const OpenInput& open, const DistributedConfig& config, Ranks& ranks,
                                    Scheduler& scheduler) {
  check(config);
  Stages stages(config, ranks, scheduler);
  DistributedResult result;
  Hierarchy& head = result.tables;
  RankInput input;
  std::optional<RankMemory> memory;
  CleanSlices clean = stages.run("reading", [&] {
    ranks.begin("reading");
    input = open(ranks, scheduler);
    check(*input.stream);
    memory = memory_of(input, config, ranks, scheduler);
    return distributed_clean(input, config.lattice, ranks, scheduler, memory->compared_items());
  });
  result.warnings = std::move(input.warnings);
  describe_input(clean, head);
  describe_config(config.build, head);

  std::unique_ptr<StoredFinest> stored;  // if the rank does not keep its cells in memory
  auto [choice, routed] = stages.run("sorting", [&] {
    FinestChoice chosen = choose_cells(*input.stream, clean, config.build, ranks);
    RoutedMesh mesh;
    if (memory->spills())
      stored = std::make_unique<StoredFinest>(*input.stream, std::move(clean), chosen, *memory, ranks, scheduler);
    else
      mesh = route_triangles(*input.stream, std::move(clean), chosen, ranks);
    input.stream.reset();
    return std::pair(std::move(chosen), std::move(mesh));
  });
  RankFinest finest = stages.run("sharing", [&] {
    ranks.begin("sharing");
    RankFinest made;
    if (stored)
      stored->share(choice, config.build.sigma0, ranks, scheduler);
    else
      made = make_rank_finest(std::move(routed), choice.grid, config.build.sigma0, ranks, scheduler);
    head.provenance.fingerprint = ranks.sum(stored ? stored->cells().fingerprint : made.fingerprint);
    return made;
  });
  stages.report.triangles = stored ? stored->triangles() : finest.triangles.size();
  const std::unique_ptr<RankLevels> levels = stages.run("building", [&]() -> std::unique_ptr<RankLevels> {
    const BlockSetting setting{config.build, choice.owners, head.transform.lattice};
    if (stored)
      return std::make_unique<StoredLevels>(std::move(stored), choice.level, setting, *memory, ranks, scheduler);
    return std::make_unique<RankLevelsInMemory>(
        build_rank_levels(std::move(finest.part), choice.level, setting, ranks, scheduler));
  });
  for (std::size_t l = 0; l < levels->level_count(); ++l) stages.report.cells += levels->codes(l).size();
  result.spilled = memory->spills();
  result.file_bytes = stages.run("writing", [&] {
    return save_ranks(
        *levels, head, config.output, [&] { result.ranks = stages.gather(); }, ranks, scheduler);
  });
  result.ranks[static_cast<std::size_t>(ranks.rank())] = stages.report;
  return result;
}

}  // namespace lodestone
